// A loop over robots by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace trundle {

// Call `work(robot, memory)` for each robot that is wanted, of all if that is null; each thread has a memory of its own.
// What one throws is thrown here.
template <typename Memory, typename Work>
void each_robot(std::size_t count, const bool *wanted, std::int64_t threads, std::size_t block, const Work &work) {
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex guard;
  const auto run = [&] {
    try {
      Memory memory;
      for (std::size_t first = next.fetch_add(block); first < count; first = next.fetch_add(block)) {
        for (std::size_t i = first; i < std::min(first + block, count); ++i) {
          if (wanted == nullptr || wanted[i]) work(i, memory);
        }
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(guard);
      failure = std::current_exception();
    }
  };
  std::vector<std::thread> others;
  const std::size_t useful = std::min(static_cast<std::size_t>(std::max<std::int64_t>(threads, 1)), count / block + 1);
  try {
    for (std::size_t i = 1; i < useful; ++i) others.emplace_back(run);
  } catch (const std::system_error &) {
    // The machine has no more threads to give; those that run do all.
  }
  run();
  for (std::thread &other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace trundle
