#pragma once
#include <string>

namespace mortise::test {

/// Small moving blocks, 10 mm, above a plate of 100 mm whose upper face is at z = 5. `head` holds
/// further keys of the scenario, one a line; `red` and `blue` are positions, blue may be left out.
struct Blocks {
  std::string head = "policy: report\n";
  std::string red = "[0, 0, 20]", blue = "[30, 0, 20]";
};
inline std::string blocks_yaml(const Blocks& blocks = {}) {
  const auto block = [](const char* name, const std::string& position) {
    return position.empty() ? std::string()
                            : std::string("  - {name: ") + name +
                                  ", generator: {kind: block, x: 10, y: 10, z: 10}, moving: true,\n"
                                  "     pose: {position: " +
                                  position + "}}\n";
  };
  return "name: blocks\nunits: mm\n" + blocks.head +
         "parts:\n  - {name: base, generator: {kind: block, x: 100, y: 100, z: 10}}\n" +
         block("red", blocks.red) + block("blue", blocks.blue);
}

/// A peg of 32 facets above its hole, Ø20 H7/g6 (as polygons they overlap by 48 um when it is in),
/// and a small block far aside; `more` holds further parts.
inline std::string peg_yaml(const std::string& more = "") {
  return R"(
name: peg
units: mm
policy: report
parts:
  - name: plate
    generator: {kind: plate_with_bore, bore: 20, facets: 32}
  - name: peg
    generator: {kind: dowel, diameter: 20, length: 40, chamfer: 1, facets: 32, phase_deg: 5.625}
    pose: {position: [0, 0, 25]}
    moving: true
    features:
      chamfer_lower: {tolerance: {lower: -0.1, upper: -0.04}}
      chamfer_upper: {tolerance: {lower: -0.1, upper: -0.04}}
  - name: block
    generator: {kind: block, x: 4, y: 4, z: 4}
    pose: {position: [100, 0, 0]}
    moving: true
)" + more +
         R"(fits:
  - {between: [plate.bore, peg.journal], code: Ø20 H7/g6}
)";
}

}  // namespace mortise::test
