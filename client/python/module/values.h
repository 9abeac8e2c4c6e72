#pragma once
#include <mortise/mortise.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <utility>

/// Values of the library as Python has them: arrays of numpy, tuples, exceptions.
namespace mortise::python {

namespace py = pybind11;

/// Raises mortise.Error.
[[noreturn]] void raise(const api::Error& error);

inline void give(const api::Status& status) {
  if (!status) raise(status.error());
}
template <class T>
T give(api::Result<T> result) {
  if (!result) raise(result.error());
  return *std::move(result);
}

/// A pose of Python: None, three numbers (a shift, mm) or a 4 x 4 matrix.
api::Pose pose_in(const py::object& pose, const char* name);
/// 4 x 4.
py::array_t<double> matrix_of(const api::Pose& X);
inline std::pair<double, double> ends_of(const api::Interval& x) { return {x.lo, x.hi}; }

/// A unit by its name: mm, cm, m, in, um.
api::Unit unit_named(const std::string& name);

void bind_parts(py::module_& module);
void bind_judgement(py::module_& module);
void bind_session(py::module_& module);
void bind_files(py::module_& module);
void bind_client(py::module_& module);

}  // namespace mortise::python
