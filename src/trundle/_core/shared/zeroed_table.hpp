// Memory that the system hands out as zeros page by page, so that a large table costs nothing until it is used.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace trundle {

template <typename T>
class ZeroedTable {
 public:
  // Holds zeros again if it grows, and its old contents otherwise.
  void fit(std::size_t size) {
    if (size <= size_) return;
    data_.reset(static_cast<T *>(std::calloc(size, sizeof(T))));
    size_ = data_ ? size : 0;
    if (!data_) throw std::bad_alloc();
  }
  void clear() { std::fill_n(data_.get(), size_, T{}); }
  T *data() { return data_.get(); }
  const T *data() const { return data_.get(); }
  T &operator[](std::size_t i) { return data_.get()[i]; }
  std::size_t bytes() const { return size_ * sizeof(T); }

 private:
  struct Free {
    void operator()(T *data) const { std::free(data); }
  };
  std::unique_ptr<T[], Free> data_;
  std::size_t size_ = 0;
};

}  // namespace trundle
