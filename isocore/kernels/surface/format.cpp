// format.cpp - Mesh files as text and records, in pieces that threads fill on their own.
#include "surface/format.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "common/parallel.hpp"

namespace isocore {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they lie in memory");

constexpr std::size_t kBlock = 8192;
constexpr std::size_t kLongestNumber = 24;
constexpr std::size_t kLongestLine = 8 + 6 * kLongestNumber;

// As printf's %.9g in the C locale.
char* append(char* to, double value) {
#if defined(__cpp_lib_to_chars)
    return std::to_chars(to, to + kLongestNumber, value, std::chars_format::general, 9).ptr;
#else
    char* end = to + std::snprintf(to, kLongestNumber, "%.9g", value);
    std::replace(to, end, ',', '.');
    return end;
#endif
}

// The number that text written by append() stands for.
double number_in(const char* text, const char* end) {
    double value = 0;
#if defined(__cpp_lib_to_chars)
    std::from_chars(text, end, value);
#else
    value = std::strtod(std::string(text, end).c_str(), nullptr);
#endif
    return value;
}

char* append(char* to, std::int32_t value) { return std::to_chars(to, to + kLongestNumber, value).ptr; }

char* append(char* to, const char* text) {
    while (*text) *to++ = *text++;
    return to;
}

// line(i, place) writes line i and returns its end.
template <class Line>
std::string join_lines(std::size_t count, int threads, const Line& line) {
    std::vector<std::string> pieces((count + kBlock - 1) / kBlock);
    parallel_for(threads, pieces.size(), [&](std::size_t piece) {
        const std::size_t begin = piece * kBlock, end = std::min(count, begin + kBlock);
        std::vector<char> buffer((end - begin) * kLongestLine);
        char* to = buffer.data();
        for (std::size_t i = begin; i < end; ++i) to = line(i, to);
        pieces[piece].assign(buffer.data(), to);
    });
    std::size_t size = 0;
    for (const std::string& piece : pieces) size += piece.size();
    std::string text;
    text.reserve(size);
    for (const std::string& piece : pieces) text += piece;
    return text;
}

// Runs record(i, place) for every record of a fixed size.
template <class Record>
Array<std::uint8_t> fill_records(std::size_t count, std::size_t size, int threads, const Record& record) {
    Array<std::uint8_t> bytes(count * size);
    parallel_for(threads, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        const std::size_t end = std::min(count, (block + 1) * kBlock);
        for (std::size_t i = block * kBlock; i < end; ++i) record(i, bytes.data() + i * size);
    });
    return bytes;
}

}  // namespace

template <class Real>
std::string format_rows(const char* tag, const Real* rows, std::size_t count, int threads) {
    return join_lines(count, threads, [=](std::size_t i, char* to) {
        to = append(to, tag);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            *to++ = ' ';
            to = append(to, static_cast<double>(rows[3 * i + axis]));
        }
        *to++ = '\n';
        return to;
    });
}

Array<double> nine_digits(const double* numbers, std::size_t count, int threads) {
    Array<double> rounded(count);
    parallel_for(threads, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        std::array<char, kLongestNumber + 1> text;
        for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
            rounded[i] = number_in(text.data(), append(text.data(), numbers[i]));
        }
    });
    return rounded;
}

std::string format_faces(const std::int32_t* triangles, std::size_t count, bool with_normals, int threads) {
    return join_lines(count, threads, [=](std::size_t t, char* to) {
        *to++ = 'f';
        for (std::size_t corner = 0; corner < 3; ++corner) {
            *to++ = ' ';
            char* number = to;
            to = append(to, triangles[3 * t + corner] + 1);
            if (!with_normals) continue;
            const char* end = to;
            to = append(to, "//");
            to = std::copy(static_cast<const char*>(number), end, to);
        }
        *to++ = '\n';
        return to;
    });
}

template <class Real>
Array<std::uint8_t> stl_records(const MeshView<Real>& mesh, int threads) {
    check_indices(mesh.triangles, mesh.triangle_count, mesh.vertex_count);
    return fill_records(mesh.triangle_count, 50, threads, [&](std::size_t t, std::uint8_t* to) {
        const std::int32_t* corners = mesh.triangles + 3 * t;
        Vec3 normal = doubled_area(mesh, corners);
        const double length = std::sqrt(dot(normal, normal));
        std::array<float, 12> values;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            values[axis] = length > 0 ? static_cast<float>(normal[axis] / length) : 0.0F;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const auto v = static_cast<std::size_t>(corners[corner]);
                values[3 + 3 * corner + axis] = static_cast<float>(mesh.vertices[3 * v + axis]);
            }
        }
        std::memcpy(to, values.data(), 48);
        to[48] = to[49] = 0;
    });
}

Array<std::uint8_t> ply_faces(const std::int32_t* triangles, std::size_t count, int threads) {
    return fill_records(count, 13, threads, [=](std::size_t t, std::uint8_t* to) {
        to[0] = 3;
        std::memcpy(to + 1, triangles + 3 * t, 12);
    });
}

template std::string format_rows(const char*, const float*, std::size_t, int);
template std::string format_rows(const char*, const double*, std::size_t, int);
template Array<std::uint8_t> stl_records(const MeshView<float>&, int);
template Array<std::uint8_t> stl_records(const MeshView<double>&, int);

}  // namespace isocore
