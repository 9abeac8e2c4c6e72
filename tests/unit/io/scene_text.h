#pragma once
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "common/io/scenario/scene_load.h"

namespace mortise {

inline LoadedScene load(const std::string& yaml) {
  const auto reading = read_scenario_text(yaml, "s.yaml");
  EXPECT_TRUE(reading);
  for (const Finding& f : reading->findings) EXPECT_FALSE(f.is_error) << f.text;
  auto scene = load_scene(reading->scenario, default_meshes());
  EXPECT_TRUE(scene);
  return std::move(scene).value();
}

/// An error of that line of the text says both.
inline void expect_error(const LoadedScene& scene, int line, const std::string& says,
                         const std::string& and_says = "") {
  EXPECT_FALSE(scene.usable());
  std::string all;
  for (const Finding& f : scene.findings) {
    all += f.text + "\n";
    if (f.is_error && f.text.starts_with("s.yaml:" + std::to_string(line) + ": ") &&
        f.text.find(says) != std::string::npos && f.text.find(and_says) != std::string::npos)
      return;
  }
  ADD_FAILURE() << "wanted line " << line << ": " << says << " ... " << and_says << "\ngot\n"
                << all;
}

}  // namespace mortise
