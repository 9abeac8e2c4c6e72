#pragma once
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

namespace mortise {

/// A vector that copies share, so that a copy costs nothing, however much it holds. Whoever changes
/// one that is shared gets its own before. Copies may be read, and made, by several threads.
template <class T>
class SharedVector {
 public:
  SharedVector() = default;
  SharedVector(std::vector<T> values)  // NOLINT: it is those values
      : values_(std::make_shared<std::vector<T>>(std::move(values))) {}
  SharedVector(std::initializer_list<T> values) : SharedVector(std::vector<T>(values)) {}

  const std::vector<T>& values() const { return values_ ? *values_ : none(); }
  operator const std::vector<T>&() const { return values(); }  // NOLINT: it is those values
  bool empty() const { return values().empty(); }
  std::size_t size() const { return values().size(); }
  const T* data() const { return values().data(); }
  const T& operator[](std::size_t i) const { return values()[i]; }
  const T& front() const { return values().front(); }
  const T& back() const { return values().back(); }
  auto begin() const { return values().begin(); }
  auto end() const { return values().end(); }

  /// Its own values, to be changed before it is copied again.
  std::vector<T>& change() {
    if (!values_)
      values_ = std::make_shared<std::vector<T>>();
    else if (values_.use_count() > 1)
      values_ = std::make_shared<std::vector<T>>(*values_);
    return *values_;
  }

  /// O(1) where they are shared.
  friend bool operator==(const SharedVector& x, const SharedVector& y) {
    return x.values_ == y.values_ || x.values() == y.values();
  }

 private:
  static const std::vector<T>& none() {
    static const std::vector<T> nothing;
    return nothing;
  }

  std::shared_ptr<std::vector<T>> values_;  // null: empty
};

}  // namespace mortise
