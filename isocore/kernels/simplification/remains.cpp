// remains.cpp - A mesh of a part, what is left of it, and a mesh of what is left of all parts.
#include "simplification/remains.hpp"

#include <algorithm>
#include <limits>

#include "common/large_pages.hpp"
#include "simplification/first_witnesses.hpp"
#include "simplification/part.hpp"

namespace isocore::simplification {

template <class Real>
void Mesh<Real>::take(const MeshArrays<Real>& input, const Part& part) {
    const std::size_t vertex_number = part.vertices.size(), count = part.triangles.size();
    from_vertices.assign(part.vertices.begin(), part.vertices.end());
    from_triangles.assign(part.triangles.begin(), part.triangles.end());
    places.resize(vertex_number);
    for (std::size_t v = 0; v < vertex_number; ++v) places[v] = {input.place(from_vertices[v]), kNone};
    triangles.resize(count);
    for (std::size_t t = 0; t < count; ++t) triangles[t] = {part.corners[t], kNone};
    proved.assign(count, 0.0f);  // as those of the reference
    sheets_.resize(input.sheets == nullptr ? 0 : count);
    for (std::size_t t = 0; t < sheets_.size(); ++t)
        sheets_[t] = (*input.sheets)[static_cast<std::size_t>(from_triangles[t])];
    vertices.assign(vertex_number, {});
    for (std::size_t v = 0; v < vertex_number; ++v)  // those outside have other triangles, too
        vertices[v].odd = !part.is_own(static_cast<std::int32_t>(v));
    constexpr int kOneThread = 1;
    find_rings(kOneThread);
    quadrics.assign(vertex_number, nullptr);
}

// The last first, so that the first is the list's head.
template <class Real>
void Mesh<Real>::take_witnesses(const MeshArrays<Real>& input, const MeshArrays<Real>& reference,
                                const FirstWitnesses& witnesses, std::size_t first) {
    std::fill(proved.begin(), proved.end(), std::numeric_limits<float>::infinity());
    for (std::size_t t = first; t < triangles.size(); ++t) {
        const auto own = witnesses.of(from_triangles[t]);
        for (std::size_t n = own.size(); n-- > 0;) {
            const std::int32_t vertex = own[n];
            from_vertices.push_back(static_cast<std::int32_t>(input.vertex_count) + vertex);
            places.push_back({reference.place(vertex), triangles[t].witness});
            triangles[t].witness = static_cast<std::int32_t>(places.size() - 1);
        }
    }
}

template <class Real>
Remains Mesh<Real>::remains(const Part& part) const {
    Remains out;
    out.first_numbered = part.first_numbered;
    out.triangles = triangles.size();
    std::vector<std::int32_t> face_of(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        if (triangles[t].is_gone()) continue;
        face_of[t] = static_cast<std::int32_t>(out.faces.size());
        const std::size_t before = out.witnesses.size();
        for (std::int32_t w = triangles[t].witness; w != kNone; w = places[static_cast<std::size_t>(w)].next)
            out.witnesses.push_back(from_vertices[static_cast<std::size_t>(w)]);
        Remains::Face face{{},
                           from_triangles[t],
                           static_cast<std::uint32_t>(t),
                           static_cast<std::uint32_t>(out.witnesses.size() - before),
                           proved[t]};
        for (std::size_t n = 0; n < 3; ++n)
            face.corners[n] = from_vertices[static_cast<std::size_t>(triangles[t].corners[n])];
        out.faces.push_back(face);
    }
    for (std::size_t v = part.first_own; v < part.end_own; ++v) {
        const Vertex& vertex = vertices[v];
        if (vertex.count == 0 && !vertex.on_curve) continue;
        out.vertices.push_back(from_vertices[v]);
        out.states.push_back(vertex);
        for (std::size_t n = 0; n < vertex.count; ++n)
            out.rings.push_back(face_of[static_cast<std::size_t>(vertex.ring[n])]);
        out.has_quadric.push_back(quadrics[v] != nullptr);
        if (quadrics[v] != nullptr) out.quadrics.push_back(*quadrics[v]);
        if (!vertex.on_curve) continue;
        const auto& ends = along(static_cast<std::int32_t>(v));
        out.along.push_back(
            {from_vertices[static_cast<std::size_t>(ends[0])], from_vertices[static_cast<std::size_t>(ends[1])]});
    }
    out.shrink_to_fit();
    return out;
}

void Remains::shrink_to_fit() {
    const auto shrink = [](auto&... lists) { (lists.shrink_to_fit(), ...); };
    shrink(vertices, states, rings, quadrics, faces, witnesses, along);
}

// Appends what is left of one part after the other to a mesh, in their order. A vertex of a part still to come is
// named by its number in the whole, as a negative one, until all of them are there.
template <class Real>
class Joining {
  public:
    Joining(Mesh<Real>& mesh, const MeshArrays<Real>& input, const std::vector<Remains>& parts)
        : mesh_(mesh), input_(input), numbers_(input.vertex_count, kNone) {
        std::size_t vertices = 0, faces = 0, rings = 0, quadrics = 0, witnesses = 0, curves = 0;
        for (const Remains& part : parts) {
            vertices += part.vertices.size();
            rings += part.rings.size();
            quadrics += part.quadrics.size();
            witnesses += part.witnesses.size();
            curves += part.along.size();
            faces +=
                static_cast<std::size_t>(std::count_if(part.faces.begin(), part.faces.end(), [&](const auto& face) {
                    return face.at >= part.first_numbered;
                }));
        }
        mesh.vertices.reserve(vertices);
        mesh.from_vertices.reserve(vertices);
        mesh.quadrics.reserve(vertices);
        mesh.places.resize(vertices);
        mesh.links.resize(witnesses);
        mesh.rings_.resize(rings);
        mesh.quadrics_.reserve(quadrics);
        mesh.triangles.reserve(faces);
        mesh.from_triangles.reserve(faces);
        mesh.proved.reserve(faces);
        if (input.sheets != nullptr) mesh.sheets_.reserve(faces);
        mesh.on_curves_.reserve(curves);
        mesh.along_.reserve(curves);
    }

    void add(const Remains& part) {
        first_ = mesh_.vertices.size();
        for (std::size_t n = 0; n < part.vertices.size(); ++n)
            numbers_[static_cast<std::size_t>(part.vertices[n])] = static_cast<std::int32_t>(first_ + n);
        add_faces(part);
        add_vertices(part);
        triangles_ += part.triangles - part.first_numbered;
    }

    void finish() {
        const auto resolve = [&](std::int32_t& vertex) {
            if (vertex < kNone) vertex = numbers_[static_cast<std::size_t>(kNone - 1 - vertex)];
        };
        for (Triangle& triangle : mesh_.triangles) {
            for (std::int32_t& corner : triangle.corners) resolve(corner);
        }
        for (auto& ends : mesh_.along_) {
            for (std::int32_t& end : ends) resolve(end);
        }
        begin_lots(triangles_);
    }

  private:
    std::int32_t number_of(std::int32_t vertex) const {
        const std::int32_t known = numbers_[static_cast<std::size_t>(vertex)];
        return known == kNone ? kNone - 1 - vertex : known;
    }

    void add_faces(const Remains& part) {
        numbers_of_faces_.clear();
        std::size_t witness = 0;
        for (const Remains::Face& face : part.faces) {
            std::int32_t number = 0;
            if (face.at >= part.first_numbered) {
                begin_lots(triangles_ + face.at - part.first_numbered + 1);
                number = static_cast<std::int32_t>(mesh_.triangles.size());
                mesh_.triangles.push_back(
                    {{number_of(face.corners[0]), number_of(face.corners[1]), number_of(face.corners[2])}, kNone});
                mesh_.from_triangles.push_back(face.number);
                mesh_.proved.push_back(face.proved);
                if (input_.sheets != nullptr)
                    mesh_.sheets_.push_back((*input_.sheets)[static_cast<std::size_t>(face.number)]);
            } else {
                number = find(face);
            }
            numbers_of_faces_.push_back(number);
            add_witnesses(part.witnesses.data() + witness, face.witnesses,
                          mesh_.triangles[static_cast<std::size_t>(number)]);
            witness += face.witnesses;
        }
    }

    // A triangle that has its number from a part before: one of its vertices was there, and knows it.
    std::int32_t find(const Remains::Face& face) const {
        for (const std::int32_t corner : face.corners) {
            const std::int32_t number = numbers_[static_cast<std::size_t>(corner)];
            if (number == kNone || static_cast<std::size_t>(number) >= first_) continue;
            const Vertex& vertex = mesh_.vertices[static_cast<std::size_t>(number)];
            return *std::find_if(vertex.ring, vertex.ring + vertex.count, [&](std::int32_t t) {
                return mesh_.from_triangles[static_cast<std::size_t>(t)] == face.number;
            });
        }
        return kNone;
    }

    // In front of those that a triangle has.
    void add_witnesses(const std::int32_t* from, std::size_t count, Triangle& triangle) {
        for (std::size_t n = count; n-- > 0;) {
            mesh_.links[next_link_ + n] = {from[n], triangle.witness};
            triangle.witness = static_cast<std::int32_t>(mesh_.places.size() + next_link_ + n);
        }
        next_link_ += count;
    }

    void add_vertices(const Remains& part) {
        std::size_t ring = 0, quadric = 0, curve = 0;
        for (std::size_t n = 0; n < part.vertices.size(); ++n) {
            const std::size_t number = first_ + n;
            mesh_.places[number] = {input_.place(part.vertices[n]), kNone};
            mesh_.from_vertices.push_back(part.vertices[n]);
            mesh_.vertices.push_back(part.states[n]);
            Vertex& vertex = mesh_.vertices.back();
            vertex.ring = mesh_.rings_.data() + next_in_rings_;
            for (std::size_t at = 0; at < vertex.count; ++at)
                mesh_.rings_[next_in_rings_++] = numbers_of_faces_[static_cast<std::size_t>(part.rings[ring++])];
            mesh_.quadrics.push_back(nullptr);
            if (part.has_quadric[n]) {
                mesh_.quadrics_.push_back(part.quadrics[quadric++]);
                mesh_.quadrics.back() = &mesh_.quadrics_.back();
            }
            if (!vertex.on_curve) continue;
            const auto& ends = part.along[curve++];
            mesh_.on_curves_.push_back(static_cast<std::int32_t>(number));
            mesh_.along_.push_back({number_of(ends[0]), number_of(ends[1])});
        }
    }

    // Lots that begin before so many of the input's triangles.
    void begin_lots(std::size_t triangles) {
        while (mesh_.lots_.size() * Mesh<Real>::kLot < triangles) mesh_.lots_.push_back(mesh_.triangles.size());
    }

    Mesh<Real>& mesh_;
    const MeshArrays<Real>& input_;
    Array<std::int32_t> numbers_;                 // of the whole's vertices, or kNone
    std::vector<std::int32_t> numbers_of_faces_;  // of the part
    std::size_t first_ = 0;                       // vertex of the part
    std::size_t triangles_ = 0;                   // of the input, in the parts before
    std::size_t next_link_ = 0, next_in_rings_ = 0;
};

template <class Real>
void Mesh<Real>::take(const MeshArrays<Real>& input, const MeshArrays<Real>& reference, std::vector<Remains>& parts) {
    input_ = input;
    reference_ = reference;
    Joining<Real> joining(*this, input, parts);
    constexpr std::size_t kAtOnce = 4;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        joining.add(parts[n]);
        parts[n] = {};
        if (n % kAtOnce == 0) return_freed_memory();
    }
    joining.finish();
}

template class Mesh<float>;
template class Mesh<double>;

}  // namespace isocore::simplification
