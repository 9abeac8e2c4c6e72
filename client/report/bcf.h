#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "client/report/report.h"

namespace mortise {

/// An issue of a BCF project. Names decide GUIDs: the same names give the same ones, so that a
/// second import updates the first.
struct BcfComment {
  std::string name, date, author, text;
};
struct BcfTopic {
  std::string name, number, status, title, priority, label, date, author, description;
  std::vector<BcfComment> comments;
  std::array<std::string, 2> parts;  ///< what is selected
  Vec3 point_W = Vec3::Zero(), normal_W = Vec3::Zero();
  double size_mm = 0.0;  ///< radius of the smaller part
  std::string png;       ///< snapshot; empty: none
};
struct BcfProject {
  std::string id, name;
  std::vector<std::string> statuses, labels;
  std::vector<BcfTopic> topics;
};

/// "high", "normal", "low" of "real", "potential" and anything else.
std::string bcf_priority(const std::string& klass);

/// A new BCF 3.0 archive (buildingSMART) with a camera on the place of each topic. Numbers of the
/// format are in metres. The file must not exist.
Status write_bcf(const BcfProject& project, const std::filesystem::path& file);

/// The clashes of a session as issues: one topic a clash with its class as label, review as status
/// and comment, both parts selected by name, and where a picture was drawn as PNG a snapshot.
Status write_bcf(const SessionReport& report, const SessionLog& log,
                 const std::filesystem::path& file);

}  // namespace mortise
