# A folder of scans into a folder of meshes, each made again only when its scan or the settings changed:
#
#     make -f meshes.mk -j4 SCANS=scans OUT=meshes ISO=300
#
# ISO may hold no value (isocore chooses), a number, otsu or pNN. BACKEND and FORMAT are those of `isocore convert`, and
# OPTIONS are any further ones of it: OPTIONS='--cap --keep-largest 1'.
# Names with spaces are beyond make; use `isocore convert scans -d meshes --if-changed` for those.
SCANS   ?= scans
OUT     ?= meshes
ISO     ?=
BACKEND ?=
FORMAT  ?= ply
OPTIONS ?=
ISOCORE ?= isocore

KNOWN    := nii nii.gz nrrd nhdr hdr mha mhd mgz mgh vti vtk vtu
SETTINGS := $(ISO:%=-i %) $(BACKEND:%=-b %) -f $(FORMAT) --no-reference --threads 1 -q $(OPTIONS)
FOUND    := $(foreach suffix,$(KNOWN),$(patsubst $(SCANS)/%.$(suffix),%,$(shell find $(SCANS) -name '*.$(suffix)')))
MESHES   := $(FOUND:%=$(OUT)/%.$(FORMAT))

ifneq ($(words $(FOUND)),$(words $(sort $(FOUND))))
  $(error $(SCANS) holds two scans of one name; give one of them another)
endif

.PHONY: all FORCE
all: $(MESHES)

$(OUT)/.settings: FORCE
	@mkdir -p $(OUT); echo '$(SETTINGS)' | cmp -s - $@ || echo '$(SETTINGS)' >$@

define rule
$(OUT)/%.$(FORMAT): $(SCANS)/%.$(1) $(OUT)/.settings
	@mkdir -p $$(dir $(OUT)/.made/$$*)
	$(ISOCORE) convert $$< -o $$@ $(SETTINGS) --depfile $(OUT)/.made/$$*.d
endef
$(foreach suffix,$(KNOWN),$(eval $(call rule,$(suffix))))

-include $(FOUND:%=$(OUT)/.made/%.d)
