#include "client/python/module/values.h"

namespace mortise::python {
namespace {

using api::CheckedPair;
using api::CheckOptions;
using api::CheckReport;
using api::Log;

api::CheckReport check(const std::vector<std::string>& files, const CheckOptions& options) {
  api::Result<CheckReport> report = [&] {
    const py::gil_scoped_release released;
    return files.size() == 1 ? api::check(files.front(), options)
                             : api::check_meshes(files, options);
  }();
  return give(std::move(report));
}

py::object column_of(const api::Column& column) {
  if (!column.is_text)
    return py::array_t<double>(static_cast<py::ssize_t>(column.numbers.size()),
                               column.numbers.data());
  return py::module_::import("numpy").attr("array")(column.texts, py::arg("dtype") = "object");
}

py::dict tables_of(const Log& log) {
  py::dict tables;
  for (const api::Table& table : log.tables) {
    py::dict columns;
    for (const api::Column& column : table.columns)
      columns[py::str(column.name)] = column_of(column);
    tables[py::str(table.name)] = columns;
  }
  return tables;
}

void bind_options(py::module_& module) {
  py::class_<CheckOptions>(module, "CheckOptions")
      .def(py::init<>())
      .def_readwrite("min_gap_mm", &CheckOptions::min_gap_mm)
      .def_readwrite("no_explain", &CheckOptions::no_explain)
      .def_readwrite("bought", &CheckOptions::bought)
      .def_readwrite("general", &CheckOptions::general)
      .def_readwrite("fit", &CheckOptions::fit)
      .def_readwrite("baseline", &CheckOptions::baseline)
      .def_readwrite("exact_volumes", &CheckOptions::exact_volumes)
      .def_readwrite("html", &CheckOptions::html)
      .def_readwrite("threads", &CheckOptions::threads)
      .def("set_unit", [](CheckOptions& o, const std::string& unit) { o.unit = unit_named(unit); });
}

void bind_pair(py::module_& module) {
  py::class_<CheckedPair>(module, "CheckedPair", "Two parts and what they are to each other.")
      .def_readonly("part_a", &CheckedPair::part_a, "path in the tree")
      .def_readonly("part_b", &CheckedPair::part_b, "path in the tree")
      .def_property_readonly(
          "collision_class", [](const CheckedPair& p) { return api::name_of(p.collision_class); },
          "of the worst place: none, fake, potential or real")
      .def_readonly("contact", &CheckedPair::contact, "they touch as drawn")
      .def_readonly("relation", &CheckedPair::relation, "thread, insert, press fit ... or unknown")
      .def_readonly("relation_text", &CheckedPair::relation_text)
      .def_readonly("explained", &CheckedPair::explained,
                    "hole and shaft account for the exact volume: no clash")
      .def_readonly("reason", &CheckedPair::reason)
      .def_readonly("count", &CheckedPair::count, "pairs of instances that stand alike")
      .def_readonly("instances", &CheckedPair::instances)
      .def_readonly("inside", &CheckedPair::inside)
      .def_readonly("muted", &CheckedPair::muted)
      .def_readonly("accuracy_mm", &CheckedPair::accuracy_mm)
      .def_readonly("common_mm3", &CheckedPair::common_mm3, "exact volume in common, or None")
      .def_readonly("thickness_mm", &CheckedPair::thickness_mm)
      .def_readonly("places", &CheckedPair::places, "Clash each, the worst first")
      .def_property_readonly("is_clash", &CheckedPair::is_clash,
                             "real or potential, and nothing explains it")
      .def("__repr__", [](const CheckedPair& p) {
        return "<mortise.CheckedPair " +
               (p.contact ? std::string("contact") : api::name_of(p.collision_class)) + ": " +
               p.part_a + " × " + p.part_b + ", " + p.relation + ">";
      });
}

void bind_report(py::module_& module) {
  py::class_<CheckReport>(module, "CheckReport", "What check() found.")
      .def_readonly("pairs", &CheckReport::pairs, "in the order in which a designer reads them")
      .def_property_readonly(
          "clashes",
          [](const CheckReport& report) {
            std::vector<CheckedPair> clashes;
            for (const CheckedPair& pair : report.pairs)
              if (pair.is_clash()) clashes.push_back(pair);
            return clashes;
          },
          "pairs that are real or potential and that nothing explains")
      .def_property_readonly(
          "near",
          [](const CheckReport& report) {
            std::vector<std::tuple<std::string, std::string, std::pair<double, double>>> near;
            for (const api::NearPair& pair : report.near)
              near.emplace_back(pair.part_a, pair.part_b, ends_of(pair.gap_mm));
            return near;
          },
          "(part, part, (lo, hi) mm) of pairs that are nearer than asked")
      .def_readonly("not_judged", &CheckReport::not_judged)
      .def_readonly("notes", &CheckReport::notes)
      .def_readonly("counts", &CheckReport::counts)
      .def_readonly("json_text", &CheckReport::json, "the document of `mortise check --json`")
      .def_readonly("text", &CheckReport::text, "the report for people")
      .def_readonly("html", &CheckReport::html, "the page, where asked for");
  module.def("check", &check, py::arg("files"), py::arg("options"));
}

void bind_reading(py::module_& module) {
  module.def(
      "load",
      [](const std::string& file, const std::string& unit) {
        const api::Unit length = unit_named(unit);
        api::Result<api::Part> part = [&] {
          const py::gil_scoped_release released;
          return api::load(file, length);
        }();
        return give(std::move(part));
      },
      py::arg("file"), py::arg("unit") = "mm");
  module.def("load_assembly", [](const std::string& file) {
    api::Result<std::vector<api::PlacedPart>> parts = [&] {
      const py::gil_scoped_release released;
      return api::load_assembly(file);
    }();
    py::list list;
    for (const api::PlacedPart& placed : give(std::move(parts)))
      list.append(py::make_tuple(placed.part, matrix_of(placed.X_WP)));
    return list;
  });
  module.def(
      "picture_svg",
      [](const api::Part& a, const api::Part& b, const std::string& fit, const py::object& X_WA,
         const py::object& X_WB) {
        const api::JudgeOptions options{fit, pose_in(X_WA, "X_WA"), pose_in(X_WB, "X_WB")};
        api::Result<std::string> svg = [&] {
          const py::gil_scoped_release released;
          return api::picture_svg(a, b, options);
        }();
        return give(std::move(svg));
      },
      py::arg("a"), py::arg("b"), py::arg("fit"), py::arg("X_WA"), py::arg("X_WB"));
}

}  // namespace

void bind_files(py::module_& module) {
  bind_reading(module);
  bind_options(module);
  bind_pair(module);
  bind_report(module);
  py::class_<Log>(module, "RawLog")
      .def_readonly("session", &Log::session)
      .def_readonly("complete", &Log::complete)
      .def_readonly("notes", &Log::notes)
      .def("tables", &tables_of);
  module.def("read_log", [](const std::string& file) {
    api::Result<Log> log = [&] {
      const py::gil_scoped_release released;
      return api::read_log(file);
    }();
    return give(std::move(log));
  });
  module.def(
      "verify_log",
      [](const std::string& file, int threads) {
        api::Result<std::uint64_t> tick = [&] {
          const py::gil_scoped_release released;
          return api::verify_log(file, threads);
        }();
        return give(std::move(tick));
      },
      py::arg("file"), py::arg("threads") = 1,
      "Computes every tick of a log again and compares; the last tick that agrees.");
}

}  // namespace mortise::python
