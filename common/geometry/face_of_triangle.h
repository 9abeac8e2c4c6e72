#pragma once
#include <algorithm>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace mortise {

/// The face of each triangle of a part. Copies share the numbers, so that comparing them costs
/// nothing, however many triangles there are; who changes one that is shared gets its own before.
class FaceOfTriangle {
 public:
  FaceOfTriangle() = default;
  FaceOfTriangle(std::vector<std::uint16_t> faces)  // NOLINT: it is those numbers
      : faces_(std::make_shared<std::vector<std::uint16_t>>(std::move(faces))) {
    seen_ = *faces_;
  }
  FaceOfTriangle(std::initializer_list<std::uint16_t> faces)
      : FaceOfTriangle(std::vector<std::uint16_t>(faces)) {}
  FaceOfTriangle(const FaceOfTriangle&) = default;  // none is moved: what is left would see faces
  FaceOfTriangle& operator=(const FaceOfTriangle&) = default;
  ~FaceOfTriangle() = default;

  bool empty() const { return seen_.empty(); }
  std::size_t size() const { return seen_.size(); }
  std::uint16_t operator[](std::size_t triangle) const { return seen_[triangle]; }
  auto begin() const { return seen_.begin(); }
  auto end() const { return seen_.end(); }

  void set(std::size_t triangle, std::uint16_t face) {
    if (faces_.use_count() > 1) *this = FaceOfTriangle(*faces_);
    (*faces_)[triangle] = face;
  }

  /// O(1) where they are shared, else O(triangles).
  friend bool operator==(const FaceOfTriangle& x, const FaceOfTriangle& y) {
    return (x <=> y) == 0;
  }
  friend std::strong_ordering operator<=>(const FaceOfTriangle& x, const FaceOfTriangle& y) {
    if (x.seen_.data() == y.seen_.data() && x.size() == y.size())
      return std::strong_ordering::equal;
    return std::lexicographical_compare_three_way(x.begin(), x.end(), y.begin(), y.end());
  }

 private:
  std::shared_ptr<std::vector<std::uint16_t>> faces_;
  std::span<const std::uint16_t> seen_;  // of faces_
};

}  // namespace mortise
