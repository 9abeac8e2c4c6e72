#include "common/generators/generators.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/generators/casing.h"
#include "common/generators/gear.h"
#include "common/generators/prismatic.h"
#include "common/generators/revolve.h"
#include "common/generators/thread.h"

namespace mortise {
namespace {

const std::vector<Family>& families() {
  static const std::vector<Family> all = [] {
    std::vector<Family> list;
    for (const auto& some : {turned_families(), prismatic_families(), casing_families(),
                             gear_families(), thread_families()})
      list.insert(list.end(), some.begin(), some.end());
    std::sort(list.begin(), list.end(),
              [](const Family& a, const Family& b) { return a.info.name < b.info.name; });
    return list;
  }();
  return all;
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

/// Lengths and angles end in their unit; what has none is counted.
bool counted(const std::string& name) { return !name.ends_with("_mm") && !name.ends_with("_rad"); }

std::string known_parameters(const GeneratorInfo& info) {
  std::string list;
  for (const auto& parameter : info.parameters) list += (list.empty() ? "" : ", ") + parameter.name;
  return list;
}

}  // namespace

const std::vector<GeneratorInfo>& generators() {
  static const std::vector<GeneratorInfo> infos = [] {
    std::vector<GeneratorInfo> list;
    for (const Family& family : families()) list.push_back(family.info);
    return list;
  }();
  return infos;
}

Result<GeneratedPart> generate(const std::string& generator,
                               const std::map<std::string, double>& parameters) {
  const auto family = std::find_if(families().begin(), families().end(),
                                   [&](const Family& f) { return f.info.name == generator; });
  if (family == families().end()) {
    std::string known;
    for (const Family& f : families()) known += (known.empty() ? "" : ", ") + f.info.name;
    return fail(Code::kNotFound, "there is no generator '" + generator + "'; known are " + known);
  }
  const GeneratorInfo& info = family->info;
  std::map<std::string, double> values;
  for (const auto& parameter : info.parameters) values[parameter.name] = parameter.fallback;
  for (const auto& [name, value] : parameters) {
    const auto known = std::find_if(info.parameters.begin(), info.parameters.end(),
                                    [&, wanted = name](const auto& p) { return p.name == wanted; });
    if (known == info.parameters.end())
      return fail(Code::kNotFound, "generator " + generator + " has no parameter '" + name +
                                       "'; known are " + known_parameters(info));
    if (!(value >= known->least && value <= known->most))
      return impossible(generator, name + " = " + number(value) + " is out of range; allowed are " +
                                       number(known->least) + " to " + number(known->most));
    if (counted(name) && value != std::floor(value))
      return impossible(generator, name + " = " + number(value) + " must be a whole number");
    values[name] = value;
  }
  return family->make(Values(std::move(values)));
}

}  // namespace mortise
