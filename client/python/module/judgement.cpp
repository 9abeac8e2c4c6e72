#include "client/python/module/values.h"

namespace mortise::python {
namespace {

api::Judgement judge(const api::Part& a, const api::Part& b, const std::string& fit,
                     const py::object& X_WA, const py::object& X_WB, bool full, int threads) {
  const api::JudgeOptions options{fit, pose_in(X_WA, "X_WA"), pose_in(X_WB, "X_WB"), full, threads};
  api::Result<api::Judgement> judgement = [&] {
    const py::gil_scoped_release released;
    return api::judge(a, b, options);
  }();
  return give(std::move(judgement));
}

api::Distance distance(const api::Part& a, const api::Part& b, const py::object& X_WA,
                       const py::object& X_WB, double limit_mm) {
  const api::Pose A = pose_in(X_WA, "X_WA"), B = pose_in(X_WB, "X_WB");
  api::Result<api::Distance> found = [&] {
    const py::gil_scoped_release released;
    return api::distance(a, b, A, B, limit_mm);
  }();
  return give(std::move(found));
}

api::FirstContact first_contact(const api::Part& a, const api::Part& b, const py::object& start,
                                const py::object& end, const py::object& X_WB,
                                const std::string& path, double accuracy_mm, double separation_mm) {
  if (path != "linear" && path != "screw")
    raise({api::Code::kInvalidInput, "path is 'linear' or 'screw'"});
  api::Motion motion;
  motion.X_W0 = pose_in(start, "start");
  motion.X_W1 = pose_in(end, "end");
  motion.path = path == "screw" ? api::Motion::Path::kScrew : api::Motion::Path::kLinear;
  const api::ContactOptions options{pose_in(X_WB, "X_WB"), accuracy_mm, separation_mm};
  api::Result<api::FirstContact> found = [&] {
    const py::gil_scoped_release released;
    return api::first_contact(a, b, motion, options);
  }();
  return give(std::move(found));
}

void bind_clash(py::module_& module) {
  using api::Clash;
  using api::WayOut;
  py::class_<WayOut>(module, "WayOut", "A motion that takes a pair apart, at constant speed.")
      .def_readonly("part", &WayOut::part, "that moves; the other one stays")
      .def_readonly("translation_mm", &WayOut::translation_mm, "(3,), world")
      .def_readonly("rotation_rad", &WayOut::rotation_rad, "(3,), rotation vector, world")
      .def_readonly("about_mm", &WayOut::about_W_mm, "(3,), the point about which it turns")
      .def_readonly("way", &WayOut::way, "along the normal, along the axis, turned and shifted ...")
      .def_readonly("path", &WayOut::path, "not asked, free, goes deeper or blocked")
      .def_readonly("blocker", &WayOut::blocker, "of blocked: the part that is met first");
  py::class_<Clash>(module, "Clash", "The judged collision of one place of two parts; mm, world.")
      .def_readonly("id", &Clash::id, "in a session: the same as long as the clash lasts")
      .def_readonly("part_a", &Clash::part_a)
      .def_readonly("part_b", &Clash::part_b)
      .def_property_readonly(
          "collision_class", [](const Clash& c) { return api::name_of(c.collision_class); },
          "none, fake, potential or real")
      .def_property_readonly(
          "depth_mm", [](const Clash& c) { return ends_of(c.depth_mm); },
          "(lo, hi): overlap of the meshes; negative: apart")
      .def_property_readonly(
          "way_out_mm", [](const Clash& c) { return ends_of(c.way_out_mm); },
          "(lo, hi): generalized penetration depth; hi inf: no way was found")
      .def_readonly("fake_up_to_mm", &Clash::fake_up_to_mm)
      .def_readonly("real_above_mm", &Clash::real_above_mm)
      .def_readonly("margin_mm", &Clash::margin_mm, "of the depth to the nearest threshold")
      .def_readonly("probability", &Clash::probability, "P(interference), or None")
      .def_readonly("point", &Clash::point_W, "(3,), the deciding place")
      .def_readonly("normal", &Clash::normal_W, "(3,), unit, from B to A")
      .def_readonly("area_mm2", &Clash::area_mm2)
      .def_readonly("witness", &Clash::witness_W, "(3,), inside both real parts, or None")
      .def_readonly("way_out", &Clash::way_out, "WayOut, or None")
      .def_readonly("face_a", &Clash::face_a)
      .def_readonly("face_b", &Clash::face_b)
      .def_readonly("grade", &Clash::grade, "where the knowledge of the mesh error comes from")
      .def_readonly("explanation", &Clash::explanation, "one sentence")
      .def("__repr__", [](const Clash& c) {
        return "<mortise.Clash " + api::name_of(c.collision_class) + ": " + c.part_a + " × " +
               c.part_b + ">";
      });
}

void bind_answers(py::module_& module) {
  using api::Distance;
  using api::FirstContact;
  using api::Judgement;
  py::class_<Judgement>(module, "Judgement", "The places where parts meet or may meet.")
      .def_readonly("clashes", &Judgement::clashes, "pair by pair, the worst place first")
      .def_readonly("notes", &Judgement::notes, "what could not be examined, and why")
      .def_readonly("json_text", &Judgement::json, "the document of `mortise judge --json`")
      .def_property_readonly(
          "worst", [](const Judgement& j) { return api::name_of(j.worst()); },
          "none, fake, potential or real");
  py::class_<Distance>(module, "Distance", "The nearest points of two parts.")
      .def_readonly("distance_mm", &Distance::distance_mm, "of the meshes; 0: they touch or cross")
      .def_readonly("within_limit", &Distance::within_limit, "False: farther than limit_mm")
      .def_readonly("point_a", &Distance::point_a_W, "(3,), world")
      .def_readonly("point_b", &Distance::point_b_W, "(3,), world");
  py::class_<FirstContact>(module, "FirstContact", "When two parts first touch, t in [0, 1].")
      .def_property_readonly(
          "state", [](const FirstContact& f) { return api::name_of(f.state); },
          "free, contact, undecided, touching_at_start or overlapping_at_start")
      .def_readonly("t_clear", &FirstContact::t_clear, "proven clear up to here")
      .def_readonly("t_contact", &FirstContact::t_contact)
      .def_readonly("distance_mm", &FirstContact::distance_mm, "at t_contact")
      .def_readonly("point_a", &FirstContact::point_a_W, "(3,), world")
      .def_readonly("point_b", &FirstContact::point_b_W, "(3,), world");
}

}  // namespace

void bind_judgement(py::module_& module) {
  bind_clash(module);
  bind_answers(module);
  const double infinity = std::numeric_limits<double>::infinity();
  module.def("judge", &judge, py::arg("a"), py::arg("b"), py::arg("fit"), py::arg("X_WA"),
             py::arg("X_WB"), py::arg("full"), py::arg("threads"));
  module.def("distance", &distance, py::arg("a"), py::arg("b"), py::arg("X_WA") = py::none(),
             py::arg("X_WB") = py::none(), py::arg("limit_mm") = infinity,
             "Distance of two meshes, exact to rounding; poses are None, a shift (3,) or a 4 x 4 "
             "matrix.");
  module.def(
      "first_contact", &first_contact, py::arg("a"), py::arg("b"), py::arg("start"), py::arg("end"),
      py::arg("X_WB") = py::none(), py::arg("path") = "linear", py::arg("accuracy_mm") = 1e-6,
      py::arg("separation_mm") = 0.0,
      "First contact of a, which moves from start to end, with b, which stands at X_WB. Never "
      "a miss, never late.");
}

}  // namespace mortise::python
