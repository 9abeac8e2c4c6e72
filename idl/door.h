#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "idl/convert.h"

/// What the conversions of convert.cpp are made of; private to it.
namespace mortise {

inline wire::Triple triple(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 vec3(const wire::Triple& t) { return {t[0], t[1], t[2]}; }
inline wire::Pose wire_pose(const Pose& X) {
  wire::Pose out;
  out.q({X.q.x(), X.q.y(), X.q.z(), X.q.w()});
  out.p_mm(triple(X.p));
  return out;
}
inline Pose pose_of(const wire::Pose& in) {
  const wire::Quadruple& q = in.q();
  return {Quat(q[3], q[0], q[1], q[2]), vec3(in.p_mm())};
}
inline wire::Interval wire_interval(const Interval& interval) {
  wire::Interval out;
  out.lo(interval.lo);
  out.hi(interval.hi);
  return out;
}
inline Interval interval_of(const wire::Interval& in) { return {in.lo(), in.hi()}; }

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
  void pose(const wire::Pose& in, const char* field) {
    const wire::Quadruple& q = in.q();
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    need(std::abs(norm - 1.0) <= kUnitNormAllowance, field);  // false when not finite
    position(in.p_mm(), field);
  }
  void interval(const wire::Interval& in, const char* field) { need(in.lo() <= in.hi(), field); }
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

  template <class T>
  void at_most_one(const std::vector<T>& values, const char* field) {
    need(values.size() <= 1, field);
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
