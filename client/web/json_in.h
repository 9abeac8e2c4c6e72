#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "common/base/result.h"
#include "common/math/types.h"
#include "common/messages/command.h"

namespace mortise::web {

/// Messages of a page (protocol.md), checked: ids in range, numbers finite, texts bounded.
struct JoinWish {
  std::string name;
  std::string page = {};  ///< known to this page alone, the same on its next line; empty: none
};
struct MoveWish {
  PartId part;
  Vec3 translation_mm = Vec3::Zero(), rotation_rad = Vec3::Zero();
};
struct CommandWish {
  std::uint64_t id = 0;  ///< the page's own, for the reply
  CommandKind kind = CommandKind::kUnknown;
  PartId part;
  Details details;
};
struct UploadWish {      ///< a mesh file that is to come by HTTP
  std::uint64_t id = 0;  ///< the page's own, for what is told of it
  std::string name;
  double unit_mm = 1.0;  ///< of the numbers in the file
  std::size_t bytes = 0;
};
struct ViewWish {  ///< world frame, mm
  Vec3 p = Vec3::Zero(), target = Vec3::Zero(), up = Vec3::Zero();
};
struct PingWish {
  double at = 0.0;
};
struct ReplayWish {
  enum class Do : std::uint8_t { kUnknown = 0, kPlay, kPause, kSeek, kSpeed };
  Do what = Do::kUnknown;
  std::uint64_t tick = 0;
  double speed = 1.0;
};
using PageMessage =
    std::variant<JoinWish, MoveWish, CommandWish, UploadWish, ViewWish, PingWish, ReplayWish>;

/// The only place where messages of browsers are read. Fails with a sentence that names the error.
Result<PageMessage> read_page_message(std::string_view text);

}  // namespace mortise::web
