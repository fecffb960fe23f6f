// Threads for many short pieces of work: each piece is done once, whoever comes in time.
#include <atomic>
#include <chrono>
#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

#include "check.hpp"
#include "common/crew.hpp"

namespace {

using namespace isocore;

void every_task_runs_once() {
    for (const int members : {-1, 1, 2, 3, 5}) {
        Crew crew(members);
        CHECK(crew.is_of(members));
        for (std::size_t round = 0; round < 300; ++round) {
            std::vector<int> runs(round % 7);  // not atomic: whoever waits for the tasks sees them
            crew.share(runs.size(), [&](std::size_t member, std::size_t n) {
                CHECK(member < crew.size());
                ++runs[n];
            });
            for (const int each : runs) CHECK(each == 1);
        }
    }
}

void members_that_sleep_are_woken() {
    Crew crew(2);
    for (int round = 0; round < 3; ++round) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        std::atomic<bool> came{false};
        crew.together([&](std::size_t member) {
            if (member == 1) came = true;
            while (!came) std::this_thread::yield();
        });
    }
}

void an_exception_is_thrown_once_all_have_ended() {
    Crew crew(3);
    for (std::size_t bad = 0; bad < 8; ++bad) {
        std::atomic<int> working{0};
        bool caught = false;
        try {
            crew.share(8, [&](std::size_t, std::size_t n) {
                ++working;
                const bool fails = n == bad;
                --working;
                if (fails) throw std::runtime_error("bad");
            });
        } catch (const std::runtime_error&) {
            caught = true;
        }
        CHECK(caught && working == 0);
    }
    std::atomic<int> runs{0};
    crew.share(8, [&](std::size_t, std::size_t) { ++runs; });
    CHECK(runs == 8);
}

}  // namespace

void test_crew() {
    every_task_runs_once();
    members_that_sleep_are_woken();
    an_exception_is_thrown_once_all_have_ended();
}
