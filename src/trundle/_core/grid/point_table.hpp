// A hash table of a search's nodes by their point on the grid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace trundle {

// Entries are numbered as they come. `Entry::at` is the point: two 32-bit numbers that give a `key()`, and `==`. To
// clear the table takes no pass over it.
template <typename Entry>
class PointTable {
 public:
  using Point = decltype(Entry::at);

  Entry &operator[](std::uint32_t entry) { return entries_[entry]; }
  const Entry &operator[](std::uint32_t entry) const { return entries_[entry]; }

  // The entry of a point, and whether it is new.
  std::pair<std::uint32_t, bool> insert(Point point) {
    if (entries_.size() * 2 >= slots_.size()) grow();
    for (std::size_t slot = hash(point);; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot].generation != generation_) {
        const auto entry = static_cast<std::uint32_t>(entries_.size());
        slots_[slot] = {generation_, entry};
        entries_.emplace_back().at = point;
        return {entry, true};
      }
      if (entries_[slots_[slot].entry].at == point) return {slots_[slot].entry, false};
    }
  }

  void clear() {
    entries_.clear();
    if (++generation_ == 0) {
      std::fill(slots_.begin(), slots_.end(), Slot{0, 0});
      generation_ = 1;
    }
  }

  std::size_t bytes() const { return slots_.capacity() * sizeof(Slot) + entries_.capacity() * sizeof(Entry); }

 private:
  struct Slot {
    std::uint32_t generation, entry;
  };

  // Fibonacci hashing: Knuth, The Art of Computer Programming, volume 3, section 6.4.
  std::size_t hash(Point point) const {
    return static_cast<std::size_t>(point.key() * 0x9e3779b97f4a7c15ULL >> shift_);
  }

  void grow() {
    slots_.assign(std::max<std::size_t>(512, slots_.size() * 2), Slot{0, 0});
    generation_ = 1;
    shift_ = 64;
    for (std::size_t size = slots_.size(); size > 1; size /= 2) --shift_;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      std::size_t slot = hash(entries_[i].at);
      while (slots_[slot].generation == generation_) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = {generation_, static_cast<std::uint32_t>(i)};
    }
  }

  std::vector<Slot> slots_;
  std::uint32_t generation_ = 0;
  int shift_ = 64;
  std::vector<Entry> entries_;
};

}  // namespace trundle
