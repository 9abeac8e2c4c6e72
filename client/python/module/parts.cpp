#include <algorithm>
#include <cstring>

#include "client/python/module/values.h"

namespace mortise::python {
namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Corners = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;

bool is_table(const py::array& array) { return array.ndim() == 2 && array.shape(1) == 3; }

api::Part part_of(const Points& points, const Corners& triangles, const std::string& name) {
  if (!is_table(points) || !is_table(triangles))
    raise({api::Code::kInvalidInput, "points and triangles are arrays of three columns"});
  api::Mesh mesh;
  mesh.points_mm.resize(static_cast<std::size_t>(points.shape(0)));
  static_assert(sizeof(api::Vec3) == 3 * sizeof(double));
  if (!mesh.points_mm.empty())
    std::memcpy(mesh.points_mm.front().data(), points.data(),
                mesh.points_mm.size() * sizeof(api::Vec3));
  mesh.triangles.resize(static_cast<std::size_t>(triangles.shape(0)));
  const std::int64_t* corner = triangles.data();
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& index : triangle) {
      if (*corner < 0 || *corner >= points.shape(0))
        raise({api::Code::kInvalidInput, "a triangle names point " + std::to_string(*corner) +
                                             " of " + std::to_string(points.shape(0))});
      index = static_cast<std::uint32_t>(*corner++);
    }
  api::Result<api::Part> part = [&] {
    const py::gil_scoped_release released;
    return api::Part::from_mesh(mesh, name);
  }();
  return give(std::move(part));
}

py::array_t<double> points_of(const api::Part& part) {
  const api::Mesh mesh = part.mesh();
  py::array_t<double> out({static_cast<py::ssize_t>(mesh.points_mm.size()), py::ssize_t{3}});
  if (!mesh.points_mm.empty())
    std::copy_n(mesh.points_mm.front().data(), 3 * mesh.points_mm.size(), out.mutable_data());
  return out;
}

py::array_t<std::uint32_t> triangles_of(const api::Part& part) {
  const api::Mesh mesh = part.mesh();
  py::array_t<std::uint32_t> out({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  if (!mesh.triangles.empty())
    std::memcpy(out.mutable_data(), mesh.triangles.data(),
                mesh.triangles.size() * sizeof(mesh.triangles.front()));
  return out;
}

api::Part generated(const std::string& kind, const std::string& name, const py::kwargs& named) {
  std::map<std::string, double> parameters;
  for (const auto& [key, value] : named)
    parameters[py::cast<std::string>(key)] = py::cast<double>(value);
  api::Result<api::Part> part = [&] {
    const py::gil_scoped_release released;
    return api::Part::generate(kind, parameters, name);
  }();
  return give(std::move(part));
}

void bind_feature(py::module_& module) {
  using api::Feature;
  py::class_<Feature>(module, "Feature", "A surface of a part by its name, in the part's frame.")
      .def_readonly("name", &Feature::name, "bore_1, shaft_2, plane_1 ...")
      .def_readonly("kind", &Feature::kind, "plane, cylinder, cone, sphere or torus")
      .def_readonly("point", &Feature::point_P, "on the plane or axis, centre, apex; mm")
      .def_readonly("axis", &Feature::axis_P, "unit: outward normal of a plane, else the axis")
      .def_readonly("radius_mm", &Feature::radius_mm, "cylinder, sphere, centre circle of a torus")
      .def_readonly("tube_radius_mm", &Feature::tube_radius_mm, "torus")
      .def_readonly("half_angle_rad", &Feature::half_angle_rad, "cone")
      .def_readonly("inward", &Feature::inward, "a bore: the material lies outside of the radius")
      .def_readonly("residual_mm", &Feature::residual_mm,
                    "largest distance of a corner of the mesh from the surface")
      .def("__repr__", [](const Feature& f) {
        return "<mortise.Feature " + f.name + ": " + f.kind + (f.inward ? ", inward" : "") + ">";
      });
}

}  // namespace

void bind_parts(py::module_& module) {
  using api::Part;
  bind_feature(module);
  py::class_<Part>(module, "Part",
                   "A rigid part: a mesh, a name and what is known of its surfaces. Immutable; any "
                   "number of threads may use one part.")
      .def(py::init(&part_of), py::arg("points"), py::arg("triangles"), py::arg("name") = "part",
           "Makes a part of triangles: points (n, 3) in mm, triangles (m, 3) of indices, "
           "counter-clockwise seen from outside. Equal points are joined.")
      .def_static("generate", &generated, py::arg("kind"), py::arg("name") = "part",
                  "Makes a part with exact surfaces: kinds and parameters (mm, rad, counts) are "
                  "those of `mortise generate --list`.")
      .def_property_readonly("name", &Part::name, "unique in a session")
      .def("named", &Part::named, py::arg("name"), "the same part under another name")
      .def_property_readonly("triangle_count", &Part::triangle_count, "of the mesh")
      .def_property_readonly("points", &points_of, "(n, 3) float64, mm: a copy")
      .def_property_readonly("triangles", &triangles_of, "(m, 3) uint32: a copy")
      .def_property_readonly("volume_mm3", &Part::volume_mm3, "signed volume of the mesh",
                             py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("has_inside", &Part::has_inside, "closed: depths can be told",
                             py::call_guard<py::gil_scoped_release>())
      .def_property_readonly("hash", &Part::hash, "of points and triangles, 32 hex digits")
      .def_property_readonly("notes", &Part::notes, "what was found and mended, for people")
      .def_property_readonly(
          "features",
          [](const Part& part) {
            const py::gil_scoped_release released;
            return std::vector<api::Feature>(part.features());
          },
          "the surfaces that a fit or tolerance can name; the first call recognizes them")
      .def(
          "save",
          [](const Part& part, const std::string& file) { give(api::save_stl(part, file)); },
          py::arg("file"), "Writes the mesh as binary STL, in mm.")
      .def("__repr__", [](const Part& part) {
        return "<mortise.Part " + part.name() + ": " + std::to_string(part.triangle_count()) +
               " triangles>";
      });
}

}  // namespace mortise::python
