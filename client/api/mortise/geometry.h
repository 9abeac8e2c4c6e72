#pragma once
/// \file
/// Parts, lengths, poses and errors. Millimetre, radian and second everywhere; W is the frame of
/// the world, P that of a part.
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace mortise::api {

/// The kind of an error, for a program to act on.
enum class Code : std::uint8_t {
  kInvalidInput,
  kNotFound,
  kUnsupported,
  kLimit,
  kMismatch,
  kRuntime
};

/// What went wrong. The text says what, where and what to do, in one line.
struct Error {
  Code code = Code::kRuntime;  ///< the kind
  std::string text;            ///< one line for people
};

/// A value, or the reason why there is none. There is no default success.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      ///< a value
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  ///< none, and why
  explicit operator bool() const { return state_.index() == 0; }             ///< is there a value?
  T& operator*() & { return std::get<0>(state_); }               ///< the value; there must be one
  const T& operator*() const& { return std::get<0>(state_); }    ///< the value; there must be one
  T&& operator*() && { return std::get<0>(std::move(state_)); }  ///< the value; there must be one
  T* operator->() { return &std::get<0>(state_); }               ///< into the value
  const T* operator->() const { return &std::get<0>(state_); }   ///< into the value
  const Error& error() const { return std::get<1>(state_); }     ///< the reason; there must be one

 private:
  std::variant<T, Error> state_;
};

/// Success, or the reason why not. May be dropped where somebody else keeps the reason.
class Status {
 public:
  Status() = default;                                 ///< success
  Status(Error error) : error_(std::move(error)) {}   ///< a failure
  explicit operator bool() const { return !error_; }  ///< success?
  const Error& error() const { return *error_; }      ///< the reason; there must be one

 private:
  std::optional<Error> error_;
};

using Vec3 = Eigen::Vector3d;  ///< a point or direction; mm where it is a length

/// A rigid motion. X_WP takes points of the part to the world: p_W = X_WP * p_P. Converts from and
/// to Eigen::Isometry3d; its layout does not depend on compiler flags.
using Pose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// lo <= true value <= hi. An end may be infinite: nothing is known on that side.
struct Interval {
  double lo = 0.0;  ///< lower end
  double hi = 0.0;  ///< upper end
};

/// The length that one unit of the numbers in a file has.
struct Unit {
  double length_mm = 1.0;  ///< > 0
};
inline constexpr Unit mm{1.0};       ///< millimetre
inline constexpr Unit cm{10.0};      ///< centimetre
inline constexpr Unit metre{1e3};    ///< metre
inline constexpr Unit inch{25.4};    ///< inch
inline constexpr Unit micron{1e-3};  ///< micrometre

/// Triangles over shared points, in the frame of the part. Counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> points_mm;                          ///< n points, finite, |x| <= 1e7 mm
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< m triples of indices below n
};

/// A surface of a part by its name, in the frame of the part.
struct Feature {
  std::string name;             ///< "bore_1", "shaft_2", "plane_1"
  std::string kind;             ///< plane, cylinder, cone, sphere or torus
  Vec3 point_P = Vec3::Zero();  ///< on the plane or axis; centre; apex. mm
  Vec3 axis_P = Vec3::UnitZ();  ///< unit: outward normal of a plane, else the axis
  double radius_mm = 0.0;       ///< cylinder, sphere; torus: of the centre circle
  double tube_radius_mm = 0.0;  ///< torus
  double half_angle_rad = 0.0;  ///< cone
  bool inward = false;          ///< the material lies outside of the radius: a bore
  double residual_mm = 0.0;     ///< largest distance of a corner of the mesh from the surface
};

/// A rigid part: a mesh, a name and what is known of its surfaces. A value: copies share what never
/// changes. Any number of threads may use one part at once.
class Part {
 public:
  /// Makes a part of triangles. Equal points are joined, triangles without area dropped, shells
  /// that face inwards turned; notes() tells. Fails on indices or coordinates out of range, and
  /// when no triangle is left. O(m log m).
  static Result<Part> from_mesh(const Mesh& mesh, const std::string& name = "part");

  /// Makes a part with exact surfaces: `generator` and `parameters` (mm, rad, counts) are those
  /// that `mortise generate --list` tells. Fails on unknown names and values out of range.
  static Result<Part> generate(const std::string& generator,
                               const std::map<std::string, double>& parameters,
                               const std::string& name = "part");

  const std::string& name() const;            ///< unique in a session; "." and "*" become "_"
  Part named(const std::string& name) const;  ///< the same part under another name
  std::size_t triangle_count() const;         ///< of the mesh
  Mesh mesh() const;                          ///< a copy of the mesh. O(m)
  double volume_mm3() const;                  ///< signed volume of the mesh. First call O(m)
  bool has_inside() const;   ///< closed, so that depths can be told. First call O(m)
  std::string hash() const;  ///< of points and triangles: 32 hex digits
  const std::vector<std::string>& notes() const;  ///< what was found and mended, for people

  /// The surfaces that a fit or tolerance can name. Of a STEP or generated part the exact ones,
  /// else those recognized in the mesh; the first call then costs about 0.1 ms a triangle.
  const std::vector<Feature>& features() const;

  struct Impl;                                      ///< private
  explicit Part(std::shared_ptr<const Impl> impl);  ///< private
  const Impl& impl() const { return *impl_; }       ///< private

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Version of the library: "major.minor.patch".
std::string version();

}  // namespace mortise::api

#ifndef MORTISE_INSIDE
/// What is offered to other programs.
namespace mortise {
using namespace api;
}
#endif
