#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "idl/convert.h"

/// What the halves of the door share; private to convert*.cpp.
namespace mortise {

inline wire::Triple triple(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 vec3(const wire::Triple& t) { return {t[0], t[1], t[2]}; }
inline wire::Quadruple quadruple(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }
inline Pose pose_of(const wire::Quadruple& q, const wire::Triple& p_mm) {
  return {Quat(q[3], q[0], q[1], q[2]), vec3(p_mm)};
}

/// Remembers the first thing that was wrong.
class Door {
 public:
  explicit Door(const char* what) : what_(what) {}

  void need(bool condition, const char* field) {
    if (!condition && fault_ == nullptr) fault_ = field;
  }
  void finite(double value, const char* field) { need(std::isfinite(value), field); }
  void number(double value, const char* field) { need(!std::isnan(value), field); }
  void count(double value, const char* field) { need(std::isfinite(value) && value >= 0, field); }
  void vector(const wire::Triple& t, const char* field) {
    need(std::all_of(t.begin(), t.end(), [](double x) { return std::isfinite(x); }), field);
  }
  void position(const wire::Triple& t, const char* field) {
    need(std::all_of(t.begin(), t.end(), [](double x) { return std::abs(x) <= kMaxCoordinate_mm; }),
         field);
  }
  void pose(const wire::Quadruple& q, const wire::Triple& p_mm, const char* field) {
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    need(std::abs(norm - 1.0) <= kUnitNormAllowance, field);  // false when not finite
    position(p_mm, field);
  }
  void interval(double lo, double hi, const char* field) { need(lo <= hi, field); }
  void name(const std::string& text, const char* field) {
    need(text_ok(text, kMaxName_bytes), field);
  }
  void text(const std::string& text, const char* field) {
    need(text_ok(text, kMaxText_bytes), field);
  }
  template <class T>
  void sequence(const std::vector<T>& values, const char* field) {
    need(values.size() <= kMaxSequence, field);
  }

  bool open() const { return fault_ == nullptr; }
  Error refusal() const {
    return fail(Code::kInvalidInput, std::string(what_) + ": " + fault_ + " is out of range");
  }

 private:
  const char* what_;
  const char* fault_ = nullptr;
};

/// Converts each entry; fails with the first that fails.
template <class Ours, class Theirs>
Status read_all(const std::vector<Theirs>& from, std::vector<Ours>& to) {
  if (from.size() > kMaxSequence) {
    return fail(Code::kInvalidInput, "a sequence has too many entries");
  }
  to.reserve(from.size());
  for (const Theirs& entry : from) {
    Result<Ours> ours = from_wire(entry);
    if (!ours) return ours.error();
    to.push_back(std::move(ours.value()));
  }
  return ok();
}

}  // namespace mortise
