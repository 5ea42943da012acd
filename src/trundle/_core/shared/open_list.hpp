// The open list of a search: a binary heap. The top is the largest entry by `<`.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace trundle {

template <typename Entry>
class OpenList {
 public:
  bool empty() const { return heap_.empty(); }
  const Entry &top() const { return heap_.front(); }

  void push(const Entry &entry) {
    heap_.push_back(entry);
    std::push_heap(heap_.begin(), heap_.end());
  }

  Entry pop() {
    std::pop_heap(heap_.begin(), heap_.end());
    const Entry entry = heap_.back();
    heap_.pop_back();
    return entry;
  }

  // Put the entries, as `change(entry)` leaves them, in order again.
  template <typename Change>
  void change_all(Change change) {
    for (Entry &entry : heap_) change(entry);
    std::make_heap(heap_.begin(), heap_.end());
  }

  void clear() { heap_.clear(); }
  std::size_t bytes() const { return heap_.capacity() * sizeof(Entry); }

 private:
  std::vector<Entry> heap_;
};

}  // namespace trundle
