"""isocore: isosurfaces of volumes and meshes."""
