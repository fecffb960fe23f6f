// format.hpp - The bytes of mesh files that would be slow to make one value at a time.
#pragma once

#include <cstdint>
#include <string>

#include "common/array.hpp"
#include "surface/mesh_view.hpp"

namespace isocore {

// "v x y z" lines, nine significant digits; tag is "v" or "vn". The same text for any number of threads.
template <class Real>
std::string format_rows(const char* tag, const Real* rows, std::size_t count, int threads);

// `count` numbers as a reader finds them in the text of format_rows: rounded to nine significant digits.
Array<double> nine_digits(const double* numbers, std::size_t count, int threads);

// "f a b c" lines, counting from one; "f a//a b//b c//c" with normals.
std::string format_faces(const std::int32_t* triangles, std::size_t count, bool with_normals, int threads);

// 50 bytes per triangle: normal, corners (float32, little-endian), two zero bytes. The normal is that of the
// vertices as given, zero for a triangle without area. Throws std::invalid_argument for an index out of range.
template <class Real>
Array<std::uint8_t> stl_records(const MeshView<Real>& mesh, int threads);

// 13 bytes per triangle: the number 3, then three int32, little-endian.
Array<std::uint8_t> ply_faces(const std::int32_t* triangles, std::size_t count, int threads);

}  // namespace isocore
