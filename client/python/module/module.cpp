#include "client/python/module/values.h"

namespace mortise::python {
namespace {

py::object& error_class() {
  static py::object& kept = *new py::object();  // never freed: the interpreter may be gone by then
  return kept;
}

const char* word_of(api::Code code) {
  switch (code) {
    case api::Code::kInvalidInput:
      return "invalid_input";
    case api::Code::kNotFound:
      return "not_found";
    case api::Code::kUnsupported:
      return "unsupported";
    case api::Code::kLimit:
      return "limit";
    case api::Code::kMismatch:
      return "mismatch";
    case api::Code::kRuntime:
      break;
  }
  return "runtime";
}

}  // namespace

void raise(const api::Error& error) {
  py::object raised = error_class()(error.text);
  raised.attr("code") = word_of(error.code);
  PyErr_SetObject(error_class().ptr(), raised.ptr());
  throw py::error_already_set();
}

api::Pose pose_in(const py::object& pose, const char* name) {
  api::Pose X = api::Pose::Identity();
  if (pose.is_none()) return X;
  const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(pose);
  if (!array) {
    PyErr_Clear();
    raise({api::Code::kInvalidInput, std::string(name) + " is no array of numbers"});
  }
  if (array.ndim() == 1 && array.shape(0) == 3) {
    X.translation() = Eigen::Vector3d(array.data());
    return X;
  }
  if (array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4)
    raise({api::Code::kInvalidInput, std::string(name) + " is None, 3 numbers or a 4 x 4 matrix"});
  using Row = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Map<const Row> matrix(array.data());
  if ((matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() != 0.0)
    raise({api::Code::kInvalidInput, std::string(name) + ": the last row must be 0 0 0 1"});
  X.matrix() = matrix;
  return X;
}

py::array_t<double> matrix_of(const api::Pose& X) {
  py::array_t<double> out({4, 4});
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(out.mutable_data()) = X.matrix();
  return out;
}

api::Unit unit_named(const std::string& name) {
  if (name == "mm") return api::mm;
  if (name == "cm") return api::cm;
  if (name == "m") return api::metre;
  if (name == "in") return api::inch;
  if (name == "um") return api::micron;
  raise({api::Code::kInvalidInput, "unit '" + name + "' is not known; write mm, cm, m, in or um"});
}

PYBIND11_MODULE(_mortise, module) {
  module.doc() = "The C++ library of mortise. Import mortise instead.";
  error_class() = py::module_::import("mortise._error").attr("Error");
  module.def("version", &api::version, "Version of the library: major.minor.patch.");
  bind_parts(module);
  bind_judgement(module);
  bind_session(module);
  bind_files(module);
  bind_client(module);
}

}  // namespace mortise::python
