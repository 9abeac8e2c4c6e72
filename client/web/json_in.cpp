#include "client/web/json_in.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "common/base/plain_text.h"
#include "common/base/ranges.h"
#include "common/messages/names.h"

namespace mortise::web {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostNameBytes = kMostUserName_bytes;
constexpr std::size_t kLeastPageBytes = 16, kMostPageBytes = 64;  // see JoinWish
// More than any field of a person needs; the session bounds each further.
constexpr std::size_t kMostTextBytes = 4096;
constexpr double kLargestId = 9007199254740992.0;  // 2^53, as far as a page counts exactly
// A nanometre to a kilometre.
constexpr double kLeastUnit_mm = 1e-6, kLargestUnit_mm = 1e6;
// 128 bits as hexadecimal digits.
constexpr std::size_t kHashDigits = 32;
constexpr double kSlowest = 0.1, kFastest = 16.0;

// Thrown and caught in this file only: a message is wrong at one place, and nothing of it counts.
struct Wrong {
  std::string text;
};

/// The keys of one message: each may be read, and all must have been.
class Keys {
 public:
  explicit Keys(const Json& json) : json_(json) {}

  bool has(const char* key) const { return json_.contains(key); }
  const Json& at(const char* key) {
    const auto found = json_.find(key);
    if (found == json_.end()) throw Wrong{std::string("'") + key + "' is missing"};
    read_.insert(key);
    return *found;
  }
  std::string text(const char* key, std::size_t most = kMostTextBytes) {
    const Json& value = at(key);
    if (!value.is_string()) throw Wrong{std::string("'") + key + "' is not a text"};
    auto text = value.get<std::string>();
    if (text.size() > most) {
      throw Wrong{std::string("'") + key + "' has more than " + std::to_string(most) + " bytes"};
    }
    return text;
  }
  double number(const char* key) {
    const Json& value = at(key);
    if (!value.is_number() || !within(value.get<double>(), kLargestNumber)) {
      throw Wrong{std::string("'") + key + "' is not a number"};
    }
    return value.get<double>();
  }
  std::uint64_t count(const char* key, double most = kLargestId) {
    const double value = number(key);
    if (value < 0.0 || value > most || value != std::floor(value)) {
      throw Wrong{std::string("'") + key + "' is not a whole number of its range"};
    }
    return static_cast<std::uint64_t>(value);
  }
  template <class Id>
  Id id(const char* key) {
    const auto value = count(key, std::numeric_limits<std::uint32_t>::max());
    if (value == 0) throw Wrong{std::string("'") + key + "' is 0; ids begin with 1"};
    return Id{static_cast<std::uint32_t>(value)};
  }
  std::vector<PartId> ids(const char* key) {
    const Json& list = at(key);
    if (!list.is_array() || list.empty() || list.size() > kMostGroupParts) {
      throw Wrong{std::string("'") + key + "' is not a list of 1 to " +
                  std::to_string(kMostGroupParts) + " parts"};
    }
    std::vector<PartId> ids;
    for (const Json& value : list) {
      const Json one{{key, value}};
      ids.push_back(Keys(one).id<PartId>(key));
    }
    return ids;
  }
  Vec3 vector(const char* key) {
    const Json& list = at(key);
    const auto in_range = [](const Json& value) {
      return value.is_number() && within(value.get<double>(), kLongest_mm);
    };
    if (!list.is_array() || list.size() != 3 || !std::all_of(list.begin(), list.end(), in_range)) {
      throw Wrong{std::string("'") + key + "' is not three numbers up to 1e9"};
    }
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
  }
  /// A unit quaternion: x, y, z, w.
  Quat rotation(const char* key) {
    const Json& list = at(key);
    const auto number = [](const Json& value) { return value.is_number(); };
    if (!list.is_array() || list.size() != 4 || !std::all_of(list.begin(), list.end(), number))
      throw Wrong{std::string("'") + key + "' is not four numbers"};
    Quat q;
    for (int i = 0; i < 4; ++i) q.coeffs()[i] = list[static_cast<std::size_t>(i)].get<double>();
    if (!valid(Pose{q, Vec3::Zero()}))
      throw Wrong{std::string("'") + key + "' is not a unit quaternion"};
    return q;
  }
  /// The value of an enum by its name; 0 is never meant, but for `first`.
  template <class Enum>
  Enum named(const char* key, std::uint8_t first, std::uint8_t count) {
    const std::string name = text(key);
    for (std::uint8_t i = first; i < count; ++i) {
      if (name_of(static_cast<Enum>(i)) == name) return static_cast<Enum>(i);
    }
    throw Wrong{std::string("'") + key + "' may not be '" + name.substr(0, 40) + "'"};
  }
  void all_read() const {
    for (const auto& [key, value] : json_.items()) {
      if (!read_.contains(key)) throw Wrong{"'" + key.substr(0, 40) + "' is not a key of it"};
    }
  }

 private:
  const Json& json_;
  std::set<std::string> read_;
};

JoinWish join_of(Keys& keys) {
  JoinWish wish{keys.text("name", kMostNameBytes)};
  if (!is_name(wish.name, kMostNameBytes)) throw Wrong{"'name' is empty, blank or not printable"};
  if (keys.has("page")) {
    wish.page = keys.text("page", kMostPageBytes);
    // A shorter one could be guessed.
    if (wish.page.size() < kLeastPageBytes)
      throw Wrong{"'page' has less than " + std::to_string(kLeastPageBytes) + " bytes"};
  }
  return wish;
}

MoveWish move_of(Keys& keys) {
  MoveWish wish;
  wish.part = keys.id<PartId>("part");
  if (keys.has("t")) wish.translation_mm = keys.vector("t");
  if (keys.has("r")) wish.rotation_rad = keys.vector("r");
  return wish;
}

void read_parts(Keys& keys, CommandWish& wish) {
  if (keys.has("parts"))
    wish.details.parts = keys.ids("parts");
  else
    wish.part = keys.id<PartId>("part");
}
void read_part(Keys& keys, CommandWish& wish) { wish.part = keys.id<PartId>("part"); }
void read_text(Keys& keys, CommandWish& wish) { wish.details.text = keys.text("text"); }
void read_any_text(Keys& keys, CommandWish& wish) {
  if (keys.has("text")) read_text(keys, wish);
}
void read_pair(Keys& keys, CommandWish& wish) {
  read_part(keys, wish);
  wish.details.other_part = keys.id<PartId>("other");
}
void read_features(Keys& keys, CommandWish& wish) {
  if (keys.has("feature")) wish.details.feature = keys.text("feature");
  if (keys.has("other_feature")) wish.details.other_feature = keys.text("other_feature");
}
void read_review(Keys& keys, CommandWish& wish) {
  wish.details.clash = keys.id<ClashId>("clash");
  wish.details.status = keys.named<ReviewStatus>("status", 0, kReviewStatusCount);
  if (keys.has("assignee")) wish.details.other_user = keys.id<UserId>("assignee");
  read_any_text(keys, wish);
}
bool read_flag(Keys& keys, const char* key) {
  if (!keys.at(key).is_boolean())
    throw Wrong{std::string("'") + key + "' is neither true nor false"};
  return keys.at(key).get<bool>();
}

void read_constraint(Keys& keys, CommandWish& wish) {
  Constraint& constraint = wish.details.constraint;
  constraint.kind = keys.named<ConstraintKind>("kind", 1, kConstraintKindCount);
  constraint.held = {keys.id<PartId>("part"), keys.text("feature")};
  constraint.other = {keys.id<PartId>("other"), keys.text("other_feature")};
  if (keys.has("distance")) constraint.distance_mm = keys.number("distance");
  if (keys.has("snap")) {
    constraint.snap = read_flag(keys, "snap");
  }
  wish.part = constraint.held.part;
}

void read_snap(Keys& keys, CommandWish& wish) {
  Constraint& constraint = wish.details.constraint;
  constraint.held.part = wish.part = keys.id<PartId>("part");
  if (keys.has("feature")) constraint.held.feature = keys.text("feature");
  if (keys.has("other")) constraint.other.part = keys.id<PartId>("other");
  if (keys.has("other_feature")) constraint.other.feature = keys.text("other_feature");
  if (keys.has("kind"))
    constraint.kind = keys.named<ConstraintKind>("kind", 1, kConstraintKindCount);
  constraint.snap = true;
}

void read_added(Keys& keys, CommandWish& wish) {
  PartEdit& edit = wish.details.edit.emplace();
  edit.name = keys.text("name", kMostName_bytes);
  edit.mesh_hash = keys.text("mesh", kHashDigits);
  edit.moving = read_flag(keys, "moving");
  if (keys.has("p")) edit.X_WP.p = keys.vector("p");
  if (keys.has("q")) edit.X_WP.q = keys.rotation("q");
}
void read_replaced(Keys& keys, CommandWish& wish) {
  read_part(keys, wish);
  wish.details.edit.emplace().mesh_hash = keys.text("mesh", kHashDigits);
}
void read_moving(Keys& keys, CommandWish& wish) {
  read_part(keys, wish);
  wish.details.edit.emplace().moving = read_flag(keys, "moving");
}

struct CommandRow {
  const char* name;
  CommandKind kind;
  std::vector<void (*)(Keys&, CommandWish&)> read;
};
const std::vector<CommandRow>& command_rows() {
  using enum CommandKind;
  static const std::vector<CommandRow> rows = {
      {"grab", kGrab, {read_parts}},
      {"release", kRelease, {read_parts}},
      {"undo", kUndo, {read_part}},
      {"redo", kRedo, {read_part}},
      {"reset", kReset, {read_part}},
      {"ask", kAskHandOver, {read_part}},
      {"withdraw", kWithdraw, {read_part}},
      {"consent", kConsent, {read_part}},
      {"decline", kDecline, {read_part, read_any_text}},
      {"policy", kSetPolicy, {read_text}},
      {"tolerance", kSetTolerance, {read_part, read_features, read_text}},
      {"fit", kSetTolerance, {read_pair, read_features, read_text}},
      {"exclude", kSetExclusion, {read_pair, read_text}},
      {"include", kDropExclusion, {read_pair}},
      {"review", kReview, {read_review}},
      {"constrain", kAddConstraint, {read_constraint}},
      {"snap", kSnap, {read_snap}},
      {"add_part", kAddPart, {read_added}},
      {"replace_part", kReplacePart, {read_replaced}},
      {"remove_part", kRemovePart, {read_part}},
      {"set_moving", kSetMoving, {read_moving}},
      {"unconstrain",
       kDropConstraint,
       {read_part,
        [](Keys& keys, CommandWish& wish) {
          wish.details.constraint_id = keys.id<ConstraintId>("constraint");
        }}},
  };
  return rows;
}

CommandWish command_of(Keys& keys) {
  CommandWish wish;
  wish.id = keys.count("id");
  const std::string what = keys.text("do");
  for (const CommandRow& row : command_rows()) {
    if (what != row.name) continue;
    wish.kind = row.kind;
    for (const auto read : row.read) read(keys, wish);
    return wish;
  }
  throw Wrong{"there is no command '" + what.substr(0, 40) + "'"};
}

UploadWish upload_of(Keys& keys) {
  UploadWish wish{keys.count("id"), keys.text("name", kMostName_bytes), 1.0,
                  static_cast<std::size_t>(keys.count("bytes"))};
  if (!is_name(wish.name, kMostName_bytes)) throw Wrong{"'name' is empty, blank or not printable"};
  if (keys.has("unit_mm")) wish.unit_mm = keys.number("unit_mm");
  if (wish.unit_mm < kLeastUnit_mm || wish.unit_mm > kLargestUnit_mm)
    throw Wrong{"'unit_mm' is not 1e-6 to 1e6"};
  return wish;
}

ReplayWish replay_of(Keys& keys) {
  ReplayWish wish;
  const std::string what = keys.text("do");
  if (what == "play") {
    wish.what = ReplayWish::Do::kPlay;
  } else if (what == "pause") {
    wish.what = ReplayWish::Do::kPause;
  } else if (what == "seek") {
    wish.what = ReplayWish::Do::kSeek;
    wish.tick = keys.count("tick");
  } else if (what == "speed") {
    wish.what = ReplayWish::Do::kSpeed;
    wish.speed = keys.number("speed");
    if (wish.speed < kSlowest || wish.speed > kFastest) throw Wrong{"'speed' is not 0.1 to 16"};
  } else {
    throw Wrong{"'do' must be play, pause, seek or speed"};
  }
  return wish;
}

// What a page wrote is repeated in messages to people.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, '?');
  return text;
}

PageMessage message_of(const std::string& type, Keys& keys) {
  if (type == "join") return join_of(keys);
  if (type == "move") return move_of(keys);
  if (type == "command") return command_of(keys);
  if (type == "upload") return upload_of(keys);
  if (type == "view") return ViewWish{keys.vector("p"), keys.vector("target"), keys.vector("up")};
  if (type == "ping") return PingWish{keys.number("at")};
  if (type == "replay") return replay_of(keys);
  throw Wrong{"is not a type of message"};
}

}  // namespace

Result<PageMessage> read_page_message(std::string_view text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return fail(Code::kInvalidInput, "the message is not JSON");
  if (!json.is_object()) return fail(Code::kInvalidInput, "the message is not a JSON object");
  std::string type;
  try {
    Keys keys(json);
    type = keys.text("type", kMostNameBytes);
    PageMessage message = message_of(type, keys);
    keys.all_read();
    return message;
  } catch (const Wrong& wrong) {
    const std::string what = type.empty() ? "the message" : "message '" + type + "'";
    return fail(Code::kInvalidInput, on_one_line(what + ": " + wrong.text));
  }
}

}  // namespace mortise::web
