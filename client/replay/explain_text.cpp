#include "client/replay/explain_text.h"

#include <fmt/format.h>

#include <cmath>

#include "common/evaluation/threshold_text.h"
#include "common/messages/length_text.h"

namespace mortise {
namespace {

// What null stands for is said by the caller.
double real(const Json& value) { return value.is_number() ? value.get<double>() : std::nan(""); }

std::string length_of(const Json& value) {
  const double mm = real(value);
  return std::isfinite(mm) ? length_text(mm) : "not bounded";
}

std::string range(const Json& interval) {
  const double hi = real(interval[1]);
  return range_text({real(interval[0]), std::isfinite(hi) ? hi : HUGE_VAL});
}

// A term of a sum.
std::string signed_length(const Json& value) {
  const double mm = real(value);
  return (mm < 0.0 ? "- " : "+ ") + length_text(std::fabs(mm));
}

std::string vector(const Json& v, int digits = 3) {
  return fmt::format("({0:.{3}f}, {1:.{3}f}, {2:.{3}f})", real(v[0]), real(v[1]), real(v[2]),
                     digits);
}

double length(const Json& v) { return std::hypot(real(v[0]), real(v[1]), real(v[2])); }

std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : ""; }

// "seat.bore"; the part alone where the face has no name.
std::string place(const Json& face) {
  const std::string name = text(face["face"]);
  return name.empty() ? text(face["part"]) : fmt::format("{}.{}", text(face["part"]), name);
}

std::string increments(const Json& chain) {
  std::string out = "1 Increments of this tick\n";
  if (chain["increments"].empty())
    out += chain["cause"] == "motion"
               ? std::string("  none for these two parts: the event follows from earlier ticks\n")
               : fmt::format("  none; the decision \"{}\" caused it\n", text(chain["cause"]));
  for (const Json& row : chain["increments"])
    out += fmt::format(
        "  {} by {}, number {}: {} mm, {} rad{}\n", text(row["part"]), text(row["user"]),
        row["seq"].dump(), vector(row["translation_mm"], 4), vector(row["rotation_rad"], 5),
        row["refused"].is_null() ? std::string()
                                 : fmt::format("; refused: {}", text(row["refused"])));
  return out;
}

std::string motion(const Json& chain) {
  std::string out = fmt::format("2 Motion, policy {}\n", text(chain["policy"]));
  for (const Json& part : chain["motion"])
    out += part["moved"].get<bool>()
               ? fmt::format("  {} went {:.4f} mm along {}, turned by {:.5f} rad\n",
                             text(part["part"]), length(part["translation_mm"]),
                             vector(part["translation_mm"], 4), length(part["rotation_rad"]))
               : fmt::format("  {} stayed where it was\n", text(part["part"]));
  const std::string sentence = text(chain["verdict"]["explanation"]);
  if (sentence.starts_with("stopped at"))
    out += "  what follows is judged where the increments would have led\n";
  return out;
}

std::string contact(const Json& chain) {
  const Json& c = chain["first_contact"];
  const auto at = [](const Json& t, const char* never) {
    return t.is_null() ? std::string(never) : fmt::format("at t = {:.4f}", real(t));
  };
  return fmt::format(
      "3 First contact, t from 0 to 1 over the tick\n  the meshes met {}\n  real parts may "
      "interfere {}, and must {}\n  from contact to target {:.4f} mm, of it {:.4f} mm along the "
      "normal\n",
      at(c["meshes_at"], "not in this tick"), at(c["possible_from"], "not in this tick"),
      at(c["real_from"], "not in this tick"), real(c["travel_mm"]), real(c["normal_travel_mm"]));
}

std::string region(const Json& chain) {
  const Json& r = chain["region"];
  return fmt::format(
      "4 Region\n  deepest at {} mm, normal {} (from the second part to the first), area {:.4g} "
      "mm²\n  overlap of the meshes {}\n",
      vector(r["point_mm"]), vector(r["normal"], 4), real(r["area_mm2"]), range(r["overlap_mm"]));
}

std::string shapes(const Json& chain) {
  const Json &a = chain["faces"][0], &b = chain["faces"][1];
  return fmt::format("5 Concave–convex\n  {} is {}, {} is {}\n", place(a), text(a["shape"]),
                     place(b), text(b["shape"]));
}

std::string faces(const Json& chain) {
  std::string out = "6 What the faces stand for";
  if (!text(chain["fit"]).empty()) out += fmt::format(", fit {}", text(chain["fit"]));
  out += "\n";
  for (const Json& face : chain["faces"]) {
    const std::string surface =
        face["has_surface"].get<bool>()
            ? fmt::format("a surface is known (radius {:.3f} mm)", real(face["radius_mm"]))
            : std::string("no surface is known");
    const std::string source = text(face["tolerance_source"]);
    out += fmt::format("  {}: {}; mesh error {} ({}), tolerance {}, {}; outward positive\n",
                       place(face), surface, range(face["deviation_mm"]), text(face["mesh_error"]),
                       range(face["tolerance_mm"]),
                       source.empty() ? "nothing declared" : fmt::format("of {}", source));
  }
  return out;
}

std::string thresholds(const Json& chain) {
  const Json& t = chain["thresholds"];
  const std::string sentence = text(chain["verdict"]["explanation"]);
  const double fake = real(t["fake_below_mm"]), above = real(t["real_above_mm"]);
  std::string out = "7 Thresholds on the overlap\n";
  const auto terms = [&](const std::string& what, const char* mesh, const char* tolerance,
                         const char* parts) {
    return fmt::format("  {} = {} for the mesh error {} for the {} real parts\n", what,
                       length_of(t[mesh]), signed_length(t[tolerance]), parts);
  };
  if (states_fake(sentence, fake))
    out += terms(fake_text(fake), "fake_by_mesh_error_mm", "fake_by_tolerance_mm", "largest");
  if (states_real(sentence, above))
    out += terms(real_text(above), "real_by_mesh_error_mm", "real_by_tolerance_mm", "least");
  return out;
}

std::string verdict(const Json& chain) {
  const Json& v = chain["verdict"];
  std::string out = fmt::format("8 Verdict: {}\n  {}\n", text(v["class"]), text(v["explanation"]));
  out += fmt::format("  margin {}; generalized penetration depth {}\n", length_of(v["margin_mm"]),
                     range(v["gpd_mm"]));
  const std::string logged = text(chain["as_logged"]);
  return out + (logged.empty() ? std::string("  the same as the log tells\n")
                               : fmt::format("  the log tells otherwise: {}\n", logged));
}

std::string history(const Json& chain) {
  std::string out = "9 What was told of it\n";
  for (const Json& row : chain["history"])
    out += fmt::format("  tick {} ({:.2f} s): {}, {}, overlap {}, {}\n", row["tick"].dump(),
                       real(row["time_s"]), text(row["what"]), text(row["class"]),
                       range(row["overlap_mm"]), text(row["status"]));
  return out;
}

}  // namespace

std::string explain_text(const Json& chain) {
  return fmt::format("Clash {}: {}, tick {} ({:.2f} s){}\n", chain["clash"].dump(),
                     text(chain["pair"]), chain["tick"].dump(), real(chain["time_s"]),
                     text(chain["user"]).empty() ? std::string()
                                                 : fmt::format(", by {}", text(chain["user"]))) +
         increments(chain) + motion(chain) + contact(chain) + region(chain) + shapes(chain) +
         faces(chain) + thresholds(chain) + verdict(chain) + history(chain);
}

}  // namespace mortise
