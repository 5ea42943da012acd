// Memory that searches borrow and give back: several threads may search at once, and none has to allocate it again.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace trundle {

template <typename Memory>
class MemoryPool {
 public:
  // The memory that was given back last, or new memory.
  std::unique_ptr<Memory> borrow() {
    std::lock_guard lock(lock_);
    if (kept_.empty()) return std::make_unique<Memory>();
    auto memory = std::move(kept_.back());
    kept_.pop_back();
    return memory;
  }

  void give_back(std::unique_ptr<Memory> memory) {
    std::lock_guard lock(lock_);
    kept_.push_back(std::move(memory));
  }

  // Frees the memory that is kept.
  void clear() {
    std::lock_guard lock(lock_);
    kept_.clear();
  }

  // Of the memory that is kept; what is borrowed does not count.
  std::size_t bytes() const {
    std::lock_guard lock(lock_);
    std::size_t sum = 0;
    for (const auto &memory : kept_) sum += memory->bytes();
    return sum;
  }

 private:
  mutable std::mutex lock_;
  std::vector<std::unique_ptr<Memory>> kept_;
};

}  // namespace trundle
