#include "client/python/module/values.h"

namespace mortise::python {
namespace {

using api::PartRef;
using api::Pushed;
using api::Session;

Session session_of(const std::string& policy, double max_jump_mm, int threads) {
  return Session({policy, max_jump_mm, threads});
}

PartRef add(Session& session, const api::Part& part, const py::object& pose, bool fixed) {
  const api::Pose X_WP = pose_in(pose, "pose");
  const PartRef ref = fixed ? session.add_fixed(part, X_WP) : session.add(part, X_WP);
  give(session.status());
  return ref;
}

Pushed push(Session& session, PartRef part, const py::object& motion) {
  const api::Pose dX_W = pose_in(motion, "dX_W");
  Pushed pushed = [&] {
    const py::gil_scoped_release released;
    return session.push(part, dX_W);
  }();
  give(pushed.status);
  return pushed;
}

void bind_session_values(py::module_& module) {
  py::class_<PartRef>(module, "PartRef", "A part of a session.")
      .def_readonly("value", &PartRef::value)
      .def("__bool__", [](PartRef ref) { return static_cast<bool>(ref); });
  py::class_<Pushed>(module, "Pushed", "What one push did.")
      .def_property_readonly(
          "pose", [](const Pushed& pushed) { return matrix_of(pushed.X_WP); },
          "(4, 4): where the part stands now")
      .def_readonly("clashes", &Pushed::clashes, "open ones of the part, the worst first")
      .def_readonly("state_hash", &Pushed::state_hash,
                    "of the whole session: the same pushes give the same");
}

void bind_statements(py::class_<Session>& session) {
  session
      .def(
          "fit",
          [](Session& s, PartRef a, const std::string& feature_a, PartRef b,
             const std::string& feature_b,
             const std::string& code) { give(s.fit(a, feature_a, b, feature_b, code)); },
          py::arg("a"), py::arg("feature_a"), py::arg("b"), py::arg("feature_b"), py::arg("code"),
          "States a fit, \"H7/g6\", of two features; \"\": of the whole parts.")
      .def(
          "tolerance",
          [](Session& s, PartRef part, const std::string& feature, const std::string& text) {
            give(s.tolerance(part, feature, text));
          },
          py::arg("part"), py::arg("feature"), py::arg("text"),
          "States a tolerance, \"±0.02\" or \"H7\", of a feature; \"\": of the whole part.")
      .def(
          "exclude",
          [](Session& s, PartRef a, PartRef b, const std::string& reason) {
            give(s.exclude(a, b, reason));
          },
          py::arg("a"), py::arg("b"), py::arg("reason") = "excluded", "The pair is never judged.");
}

}  // namespace

void bind_session(py::module_& module) {
  bind_session_values(module);
  py::class_<Session> session(
      module, "Session", "Parts that users hold and push in this process, each collision judged.");
  bind_statements(session);
  session
      .def(py::init(&session_of), py::arg("policy") = "stop", py::arg("max_jump_mm") = 50.0,
           py::arg("threads") = 1)
      .def("add", &add, py::arg("part"), py::arg("pose") = py::none(), py::arg("fixed") = false,
           "Adds a part; a fixed one stands.")
      .def(
          "hold",
          [](Session& s, const std::string& user, PartRef part) {
            const api::Status done = [&] {
              const py::gil_scoped_release released;
              return s.hold(user, part);
            }();
            give(done);
          },
          py::arg("user"), py::arg("part"), "Gives a part to a user, who joins.")
      .def(
          "release", [](Session& s, PartRef part) { give(s.release(part)); }, py::arg("part"))
      .def(
          "place",
          [](Session& s, PartRef part, const py::object& pose) {
            give(s.place(part, pose_in(pose, "pose")));
          },
          py::arg("part"), py::arg("pose"), "Puts a part somewhere without a motion.")
      .def("push", &push, py::arg("part"), py::arg("dX_W"),
           "Pushes a held part: its pose becomes dX_W @ pose, as far as the policy lets it.")
      .def(
          "judge",
          [](Session& s, bool full) {
            api::Result<api::Judgement> judgement = [&] {
              const py::gil_scoped_release released;
              return s.judge(full);
            }();
            return give(std::move(judgement));
          },
          py::arg("full") = false, "Judges all pairs where they stand. Moves nothing.")
      .def_property_readonly("clashes", &Session::clashes, "all open ones, the worst first")
      .def(
          "pose", [](const Session& s, PartRef part) { return matrix_of(s.pose(part)); },
          py::arg("part"), "(4, 4)")
      .def("name", &Session::name, py::arg("part"))
      .def("find", &Session::find, py::arg("name"));
}

}  // namespace mortise::python
