// bind_grid_thinning.cpp - The class GridIndex: a volume and its skeleton, thinned once and then ready to propagate
// one isovalue after the other. Samples of every type make the same class.
#include <algorithm>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>

#include "python/arrays.hpp"
#include "python/bindings.hpp"
#include "python/named_tuple.hpp"
#include "samples/sample_types.hpp"
#include "thinning/grid/grid_thinning.hpp"
#include "thinning/zeroed.hpp"

namespace isocore::python {
namespace {

// Keeps the samples alive. Calls share the marks that they leave and take back, so they take turns.
class GridIndex {
  public:
    template <class Sample>
    GridIndex(const VolumeArray<Sample>& samples, bool below, bool capped)
        : single_(floats_suffice(grid_view(samples).dims)) {
        const thinning::GridOptions options{below, capped};
        propagate_ = [=, this](double isovalue, int threads) {
            const thinning::GridSkeletonView skeleton{skeleton_.cells.data(), skeleton_.low.data(),
                                                      skeleton_.high.data(), skeleton_.cells.size(), place_.data()};
            return thinning::propagate_grid(grid_view(samples), skeleton, isovalue, options, threads);
        };
        const nb::gil_scoped_release unlocked;
        skeleton_ = thinning::thin_grid(grid_view(samples), options);
        place_ = thinning::Zeroed(skeleton_.volume_cells);
    }

    std::size_t cells() const { return skeleton_.volume_cells; }
    std::size_t extrema() const { return skeleton_.extrema; }
    std::size_t skeleton_cells() const { return skeleton_.cells.size(); }

    nb::object propagate(double isovalue, int threads, const NamedTuple& walked_volume) {
        thinning::GridMesh mesh;
        Array<float> rounded;
        {
            const nb::gil_scoped_release unlocked;
            const std::lock_guard<std::mutex> alone(one_at_a_time_);
            mesh = propagate_(isovalue, threads);
            if (single_) {
                rounded.resize(mesh.vertices.size());
                std::transform(mesh.vertices.begin(), mesh.vertices.end(), rounded.begin(),
                               [](double coordinate) { return static_cast<float>(coordinate); });
            }
        }
        return walked_volume(single_ ? to_numpy(std::move(rounded), 3) : to_numpy(std::move(mesh.vertices), 3),
                             to_numpy(std::move(mesh.triangles), 3), mesh.seeds, mesh.visited, mesh.ambiguous_faces,
                             mesh.ambiguous_cells);
    }

  private:
    bool single_;  // vertices in float32
    thinning::GridSkeleton skeleton_;
    thinning::Zeroed place_;
    std::function<thinning::GridMesh(double isovalue, int threads)>
        propagate_;  // holds the samples, whatever their type
    std::mutex one_at_a_time_;
};

}  // namespace

void bind_grid_thinning(nb::module_& module) {
    using nb::arg;
    const NamedTuple walked_volume(module, "WalkedVolume",
                                   {"vertices", "triangles", "seeds", "visited", "ambiguous_faces", "ambiguous_cells"});
    nb::class_<GridIndex> index(module, "GridIndex");
    for_each_sample_type([&]<class Sample>() {
        index.def(nb::init<const VolumeArray<Sample>&, bool, bool>(), arg("samples").noconvert(), arg("below") = false,
                  arg("capped") = false);
    });
    index.def_prop_ro("cells", &GridIndex::cells)
        .def_prop_ro("extrema", &GridIndex::extrema)
        .def_prop_ro("skeleton_cells", &GridIndex::skeleton_cells)
        .def(
            "propagate",
            [=](GridIndex& self, double isovalue, int threads) {
                return self.propagate(isovalue, threads, walked_volume);
            },
            arg("isovalue"), arg("threads") = 1);
}

}  // namespace isocore::python
