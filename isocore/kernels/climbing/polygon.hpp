// polygon.hpp - Cuts the loop of a highrice into triangles. A diagonal whose ends share a face of the box could be
// drawn by the neighbour too and is not taken; of the others the cheapest set is found by dynamic programming.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <vector>

#include "climbing/vectors.hpp"

namespace isocore::climbing {

struct Corner {
    Point place;
    unsigned faces;
    std::int32_t vertex;
};

class Polygon {
  public:
    using Triangle = std::array<std::size_t, 3>;  // numbers of corners

    std::vector<Corner> corners;

    // Calls draw(a, b, c), numbers of corners, for each of corners.size() - 2 triangles.
    template <class Draw>
    void cut(const Draw& draw) {
        const std::size_t n = corners.size();
        if (n == 3) return draw(0, 1, 2);
        if (n == 4) return cut_four(draw);
        if (cost_.size() < n * n) {
            cost_.resize(n * n);
            apex_.resize(n * n);
        }
        for (std::size_t i = 0; i + 1 < n; ++i) cost_[i * n + i + 1] = 0;
        for (std::size_t span = 2; span < n; ++span) {
            for (std::size_t i = 0; i + span < n; ++i) find_apex(i, i + span);
        }
        if (!std::isfinite(cost_[n - 1])) throw std::logic_error("a loop has no legal triangulation");
        draw_part(0, n - 1, draw);
    }

  private:
    // What find_apex() would find, without its tables: most loops are this short.
    template <class Draw>
    void cut_four(const Draw& draw) const {
        const auto price = [&](std::size_t a, std::size_t b, std::size_t c) { return area(corners[a].place, corners[b].place, corners[c].place); };
        const bool may_even = !(corners[0].faces & corners[2].faces), may_odd = !(corners[1].faces & corners[3].faces);
        if (!may_even && !may_odd) throw std::logic_error("a loop has no legal triangulation");
        if (may_even && (!may_odd || price(0, 2, 3) + price(0, 1, 2) < price(0, 1, 3) + price(1, 2, 3))) {
            draw(0, 2, 3);
            draw(0, 1, 2);
        } else {
            draw(0, 1, 3);
            draw(1, 2, 3);
        }
    }

    // The triangles between the corners i ... j and the line from i to j.
    template <class Draw>
    void draw_part(std::size_t i, std::size_t j, const Draw& draw) const {
        if (j - i < 2) return;
        const std::size_t k = apex_[i * corners.size() + j];
        draw(i, k, j);
        draw_part(i, k, draw);
        draw_part(k, j, draw);
    }

    void find_apex(std::size_t i, std::size_t j) {
        const std::size_t n = corners.size();
        double best = std::numeric_limits<double>::infinity();
        const bool side = i == 0 && j == n - 1;
        if (side || !(corners[i].faces & corners[j].faces)) {
            for (std::size_t k = i + 1; k < j; ++k) {
                const double rest = cost_[i * n + k] + cost_[k * n + j];
                if (!(rest < best)) continue;
                const double price = rest + area(corners[i].place, corners[k].place, corners[j].place);
                if (price < best) {
                    best = price;
                    apex_[i * n + j] = k;
                }
            }
        }
        cost_[i * n + j] = best;
    }

    static double area(const Point& a, const Point& b, const Point& c) {
        const Point normal = cross(minus(b, a), minus(c, a));
        return std::sqrt(dot(normal, normal));
    }

    std::vector<double> cost_;
    std::vector<std::size_t> apex_;
};

}  // namespace isocore::climbing
