#include "client/python/module/values.h"

namespace mortise::python {
namespace {

using api::Client;
using api::Heard;
using api::LiveEvent;
using api::LivePart;

Client join(const std::string& user, const api::ClientOptions& options) {
  api::Result<Client> client = [&] {
    const py::gil_scoped_release released;
    return Client::join(user, options);
  }();
  return give(std::move(client));
}

// A function of the client that waits, while other threads of Python go on.
template <class Call>
auto waiting(Call call) {
  const py::gil_scoped_release released;
  return call();
}

void bind_live_values(py::module_& module) {
  py::class_<LivePart>(module, "LivePart", "What a client knows of a part.")
      .def_readonly("name", &LivePart::name)
      .def_property_readonly("pose", [](const LivePart& part) { return matrix_of(part.X_WP); })
      .def_readonly("moving", &LivePart::moving)
      .def_readonly("holder", &LivePart::holder);
  py::class_<LiveEvent>(module, "LiveEvent", "A clash begins, changes, ends or is reviewed.")
      .def_readonly("kind", &LiveEvent::kind)
      .def_readonly("tick", &LiveEvent::tick)
      .def_readonly("user", &LiveEvent::user)
      .def_readonly("clash", &LiveEvent::clash);
  py::class_<Heard>(module, "Heard", "What came while a client listened.")
      .def_readonly("events", &Heard::events, "in order, none twice")
      .def_readonly("refused", &Heard::refused, "moves that were refused, and why")
      .def_readonly("server_lost", &Heard::server_lost);
  using api::ClientOptions;
  py::class_<ClientOptions>(module, "ClientOptions")
      .def(py::init<>())
      .def_readwrite("session", &ClientOptions::session)
      .def_readwrite("domain", &ClientOptions::domain)
      .def_readwrite("interface", &ClientOptions::interface)
      .def_readwrite("server", &ClientOptions::server)
      .def_readwrite("discovery_server", &ClientOptions::discovery_server)
      .def_readwrite("discovery_port", &ClientOptions::discovery_port)
      .def_readwrite("keys", &ClientOptions::keys)
      .def_readwrite("role", &ClientOptions::role)
      .def_readwrite("wait_s", &ClientOptions::wait_s);
}

}  // namespace

void bind_client(py::module_& module) {
  bind_live_values(module);
  module.def("join", &join, py::arg("user"), py::arg("options"));
  py::class_<Client>(module, "RawClient")
      .def("parts", &Client::parts)
      .def("open_clashes", &Client::open_clashes)
      .def("grab",
           [](Client& client, const std::string& part) {
             give(waiting([&] { return client.grab(part); }));
           })
      .def("release",
           [](Client& client, const std::string& part) {
             give(waiting([&] { return client.release(part); }));
           })
      .def("move",
           [](Client& client, const std::string& part, const py::object& motion) {
             give(client.move(part, pose_in(motion, "dX_W")));
           })
      .def("listen", [](Client& client,
                        double seconds) { return waiting([&] { return client.listen(seconds); }); })
      .def("server_present", &Client::server_present);
}

}  // namespace mortise::python
