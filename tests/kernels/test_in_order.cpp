// Parts of bars that several threads bring come out in the order of the bars, and nobody waits for ever.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <random>
#include <thread>
#include <vector>

#include "check.hpp"
#include "climbing/triangles/in_order.hpp"
#include "common/array.hpp"
#include "common/parallel.hpp"

namespace {

using namespace isocore;
using namespace isocore::climbing;

// Each number tells its bar and which of the bar's it is.
std::vector<std::vector<std::int32_t>> random_bars(std::mt19937& random, std::size_t count) {
    std::vector<std::vector<std::int32_t>> bars(count);
    for (std::size_t n = 0; n < count; ++n) {
        const std::size_t size = random() % 3 ? random() % 50 : 0;
        for (std::size_t i = 0; i < size; ++i) bars[n].push_back(static_cast<std::int32_t>(1000 * n + i));
    }
    return bars;
}

void bars_come_out_in_their_order(int threads, std::size_t most_early) {
    std::mt19937 random(31);
    for (int trial = 0; trial < 20; ++trial) {
        const auto bars = random_bars(random, 1 + random() % 60);
        std::vector<std::int32_t> expected;
        for (const auto& bar : bars) expected.insert(expected.end(), bar.begin(), bar.end());
        Array<std::int32_t> out(expected.size());
        InOrder in_order(bars.size(), most_early, out);
        parallel_for(threads, bars.size(), [&](std::size_t n) {
            in_order.begin(n);
            if (n % 7 == 0) std::this_thread::sleep_for(std::chrono::microseconds(300));  // lost its core
            const auto& bar = bars[n];
            for (std::size_t first = 0; first < bar.size(); first += 9) {
                in_order.put(n, {bar.data() + first, std::min<std::size_t>(9, bar.size() - first)});
            }
            in_order.end(n);
        });
        CHECK(std::vector<std::int32_t>(out.begin(), out.end()) == expected);
    }
}

const std::vector<std::int32_t> kNumber{7};

// Bar 0 has begun, and bar 1 has a number that waits for it.
void keep_one_aside(InOrder& in_order) {
    in_order.begin(0);
    in_order.begin(1);
    in_order.put(1, kNumber);
}

// With room for no early numbers, a bar is begun only once those before it are out, or none of them has any numbers
// yet.
void no_bar_begins_while_too_much_is_kept_aside() {
    Array<std::int32_t> out(4);
    InOrder in_order(4, 0, out);
    keep_one_aside(in_order);
    in_order.end(1);
    std::atomic<bool> has_begun{false};
    std::thread third([&] {
        in_order.begin(2);
        has_begun = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    CHECK(!has_begun);
    in_order.put(0, kNumber);
    in_order.end(0);
    third.join();
    CHECK(has_begun);
}

void nobody_waits_for_a_bar_that_failed() {
    Array<std::int32_t> out(4);
    InOrder in_order(4, 0, out);
    keep_one_aside(in_order);
    std::thread third([&] { in_order.begin(2); });
    in_order.give_up();
    third.join();
    in_order.begin(3);
}

}  // namespace

void test_in_order() {
    for (const int threads : {1, 2, 5}) {
        for (const std::size_t most_early : {std::size_t{0}, std::size_t{20}, std::size_t{100000}})
            bars_come_out_in_their_order(threads, most_early);
    }
    no_bar_begins_while_too_much_is_kept_aside();
    nobody_waits_for_a_bar_that_failed();
}
