#include "tests/lint/house_rules.h"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "tests/lint/blocks.h"
#include "tests/lint/constants.h"

namespace mortise::lint {
namespace {

namespace fs = std::filesystem;

// A room may include itself, the rooms named here, and whatever those may include. The longest path
// that begins the name of a file says in which room it lies.
struct Room {
  std::string path;
  std::vector<std::string> may_use;
};
const std::vector<Room> kRooms = {
    {"common/base/", {}},
    {"common/math/", {"common/base/"}},
    {"common/messages/", {"common/math/"}},
    {"common/geometry/", {"common/messages/"}},
    {"common/motion/", {"common/math/"}},
    {"common/broadphase/", {"common/geometry/", "common/motion/"}},
    {"common/ccd/", {"common/geometry/", "common/motion/"}},
    // Other rooms may not include search, answer and gpd, and none of the folders a later one.
    {"common/depth/", {"common/ccd/", "common/depth/cells"}},
    {"common/depth/cells", {"common/depth/"}},
    {"common/depth/search", {"common/depth/"}},
    {"common/depth/answer", {"common/depth/search"}},
    {"common/depth/gpd", {"common/depth/"}},
    {"common/evaluation/", {"common/geometry/", "common/messages/"}},
    {"common/session/", {"common/broadphase/", "common/depth/", "common/evaluation/"}},
    {"common/generators/", {"common/geometry/"}},
    {"common/io/build_info", {"common/base/"}},
    {"common/io/program_process", {"common/base/"}},
    {"common/io/usage", {"common/io/program_process"}},
    {"common/io/progress_log", {"common/base/"}},
    {"common/io/scenario/yaml_document", {"common/base/"}},
    {"common/io/scenario/play_file", {"common/messages/", "common/io/scenario/yaml_document"}},
    {"common/io/",
     {"common/io/build_info", "common/io/usage", "common/io/scenario/play_file", "common/session/",
      "common/generators/"}},
    {"idl/", {"common/messages/"}},
    {"idl/network_options", {"idl/", "common/io/usage"}},
    {"server/", {"common/io/", "common/io/progress_log", "idl/network_options"}},
    {"client/",
     {"common/messages/", "common/io/build_info", "common/io/progress_log", "idl/network_options"}},
    {"client/bot/", {"client/", "common/io/scenario/play_file"}},
    {"client/web/", {"client/"}},
    {"client/web/recording", {"client/web/", "common/io/"}},
    {"client/web/step_reader", {"client/web/", "common/io/"}},
    {"client/web/replay_feed", {"client/web/recording"}},
    {"client/web/run",
     {"client/web/replay_feed", "client/web/step_reader", "client/report/", "client/saved/"}},
    {"client/web/main", {"client/web/run"}},
    {"client/picture/", {"common/session/"}},
    {"client/report/", {"client/picture/", "common/io/"}},
    {"client/saved/", {"client/tools/", "common/io/"}},
    {"client/replay/",
     {"client/", "client/report/", "client/saved/", "client/tools/", "common/io/"}},
    {"client/tools/", {"client/", "client/picture/", "common/io/"}},
    {"client/tools/check/", {"client/tools/", "client/report/"}},
    {"client/api/",
     {"client/api/mortise", "client/", "client/tools/check/", "client/tools/", "client/report/",
      "client/picture/", "common/io/", "idl/"}},
    // What other programs see names nothing of the house, and neither do they.
    {"client/api/mortise", {}},
    {"client/api/examples", {}},
    {"client/python/", {}},
    {"tests/",
     {"server/", "client/bot/", "client/web/", "client/web/replay_feed", "client/web/step_reader",
      "client/replay/", "client/report/", "client/saved/", "client/picture/", "client/tools/",
      "client/tools/check/", "common/depth/answer", "common/depth/gpd", "tests/"}},
};

// A library that is named in some places only. Tests may use what they test against.
struct NamedHere {
  std::string library;
  std::regex include;
  std::vector<std::string> places;
};
const std::vector<NamedHere>& named_here() {
  static const std::vector<NamedHere> rules = {
      {"FCL", std::regex("fcl/.*"), {"common/broadphase/", "tests/"}},
      {"libccd", std::regex("ccd/ccd\\.h"), {"tests/bench/"}},
      {"Bullet", std::regex("(Bullet.*|LinearMath)/.*"), {"tests/"}},
      {"assimp",
       std::regex("assimp/.*"),
       {"common/io/mesh/mesh_import", "common/io/mesh/importer/"}},
      {"OpenCASCADE", std::regex(".*\\.hxx"), {"common/io/step/importer/", "tests/assemblies/"}},
      {"yaml-cpp", std::regex("yaml-cpp/.*"), {"common/io/scenario/"}},
      {"Fast DDS",
       std::regex("(fastdds|fastrtps|fastcdr)/.*"),
       {"idl/", "tests/unit/idl/fast_dds_overrides_test."}},
      {"spdlog", std::regex("spdlog/.*"), {"common/io/progress_log.cpp"}},
      {"zstd", std::regex("zstd\\.h"), {"common/io/log/mcap_"}},
      {"SQLite", std::regex("sqlite3\\.h"), {"client/report/", "tests/unit/replay/export_test."}},
      {"libzip",
       std::regex("zip\\.h"),
       {"client/report/bcf.", "client/saved/", "tests/unit/replay/"}},
      {"pugixml",
       std::regex("pugixml\\.hpp"),
       {"client/report/bcf.", "common/io/mesh/importer/", "tests/unit/replay/"}},
      {"Boost.Beast",
       std::regex("boost/(beast|asio).*"),
       {"client/web/", "server/metrics_endpoint.", "server/etcd_client.", "server/discovery/",
        "tests/network/page_client."}},
      {"OpenSSL",
       std::regex("openssl/.*"),
       {"client/web/", "idl/identity.", "server/etcd_client.", "common/io/log/log_seal",
        "common/io/log/openssl_owner.", "tests/network/page_client."}},
      {"Cairo", std::regex("cairo.*"), {"client/picture/canvas.cpp"}},
      {"pybind11", std::regex("pybind11/.*"), {"client/python/"}},
      {"CLI11", std::regex("CLI/.*"), {"common/io/usage.", "tests/bench/"}},
  };
  return rules;
}

// What fastddsgen makes from idl/mortise.idl lies in the folder of the build.
const std::regex kGenerated("mortise[A-Za-z]*\\.(h|hpp|ipp)");

// A class and a function hold one idea each and can be read in one go; files have no limit, because
// a limit cuts ideas in halves. A test tells one story from its scene to its outcome and may be
// longer.
constexpr std::size_t kMostClassLines = 300, kMostFunctionLines = 60, kMostTestLines = 100,
                      kMostMainLines = 60;

// A document is read beside code: a longer line does not fit.
constexpr std::size_t kMostLineLength = 160;

// The documents that a newcomer reads to their end, and their most words.
const std::map<std::string, std::size_t> kMostWords = {{"README.md", 900}, {"CHANGELOG.md", 600}};

// The document that says where things are.
const std::string kNamesPlaces = "CONTRIBUTING.md";

const std::set<std::string> kCodeEndings = {".h", ".hpp", ".cpp", ".c"};
const std::set<std::string> kTextEndings = {
    ".h",    ".hpp", ".cpp",   ".c",    ".mjs", ".js",  ".html", ".css", ".md", ".txt",
    ".yaml", ".yml", ".cmake", ".json", ".idl", ".xml", ".sh",   ".py",  ""};

bool is_left_out(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == ".git" || name == ".cache" || name == "node_modules" || name == "sessions" ||
         name == "build" || name.starts_with("build-");
}

const Room* room_of(const std::string& file) {
  const Room* best = nullptr;
  for (const Room& room : kRooms)
    if (file.starts_with(room.path) && (best == nullptr || room.path.size() > best->path.size()))
      best = &room;
  return best;
}

// All rooms that a room may include, itself among them.
std::set<std::string> reach_of(const Room& from) {
  std::set<std::string> reach = {from.path};
  std::vector<std::string> open = from.may_use;
  while (!open.empty()) {
    const std::string next = open.back();
    open.pop_back();
    if (!reach.insert(next).second) continue;
    for (const Room& room : kRooms)
      if (room.path == next) open.insert(open.end(), room.may_use.begin(), room.may_use.end());
  }
  return reach;
}

class HouseCheck {
 public:
  HouseCheck(fs::path root, const std::set<std::string>& known_long)
      : root_(std::move(root)), known_long_(known_long) {}

  std::vector<std::string> run() {
    for (auto entry = fs::recursive_directory_iterator(root_);
         entry != fs::recursive_directory_iterator(); ++entry) {
      if (entry->is_directory() && is_left_out(entry->path()))
        entry.disable_recursion_pending();
      else if (entry->is_regular_file() && entry->path().filename() != ".git")
        file(entry->path());
    }
    for (const std::string& room : readme_rooms_)
      if (!fs::exists(root_ / room / "README.md"))
        broken_.push_back(room + ": the room has no README.md");
    for (const auto& [name, lines] : class_lines_) too_long(name, "", lines, kMostClassLines);
    for (const std::string& name : known_long_)
      if (!long_.contains(name))
        broken_.push_back(name + ": is not too long any more: strike it from the known ones");
    std::sort(broken_.begin(), broken_.end());
    return broken_;
  }

 private:
  void file(const fs::path& path) {
    const std::string name = path.lexically_relative(root_).generic_string();
    const std::string ending = path.extension().string();
    if (!kTextEndings.contains(ending)) return;
    const bool is_code = kCodeEndings.contains(ending);
    const Room* room = room_of(name);
    if (room != nullptr && is_code) remember_readme(*room);
    if (room == nullptr && is_code) broken_.push_back(name + ": lies in no room of the house");

    std::ifstream in(path);
    std::ostringstream text;
    text << in.rdbuf();
    std::istringstream whole(text.str());
    std::string line, comments;
    std::size_t lines = 0;
    while (std::getline(whole, line)) {
      ++lines;
      const std::string place = name + ":" + std::to_string(lines);
      if (is_code && room != nullptr) include_line(*room, name, place, line);
      machine_path(place, line);
      if (ending == ".md") document_line(place, line);
      if (is_code) add_comment(line, comments);
    }
    citations(name, comments);
    if (name == kNamesPlaces) places(name, text.str());
    words(name, text.str());
    if (path.filename() == "main.cpp") too_long(name, "", lines, kMostMainLines);
    if (is_code) lengths(name, text.str());
    if (is_code && !name.starts_with("tests/"))
      for (const BareConstant& bare : constants_without_reason(text.str()))
        broken_.push_back(name + ":" + std::to_string(bare.line) + ": " + bare.name +
                          " has no reason: say above or behind it why it is so large");
  }

  void remember_readme(const Room& room) {
    // What shares its folder with a room is told by that room's README.
    if (room.path.ends_with('/')) readme_rooms_.insert(room.path.substr(0, room.path.size() - 1));
  }

  // `name` is what the known ones are called by, `line` where it stands now.
  void too_long(const std::string& name, const std::string& line, std::size_t lines,
                std::size_t most) {
    if (lines <= most) return;
    long_.insert(name);
    if (!known_long_.contains(name))
      broken_.push_back(name + line + " has " + std::to_string(lines) + " lines, at most " +
                        std::to_string(most));
  }

  void lengths(const std::string& name, const std::string& text) {
    const std::string folder = name.substr(0, name.rfind('/') + 1);
    const std::vector<Block> blocks = blocks_of(text);
    const auto is_defined_here = [&](const std::string& owner) {
      return std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) {
        return block.kind == Block::Kind::kClass && block.name == owner;
      });
    };
    for (const Block& block : blocks) {
      const bool is_class = block.kind == Block::Kind::kClass;
      if (!is_class)
        too_long(name + ": " + block.name, " (line " + std::to_string(block.line) + ")",
                 block.lines, name.starts_with("tests/") ? kMostTestLines : kMostFunctionLines);
      // A member that stands outside of its class counts to the class: of this source, or else of
      // a header of the folder.
      const std::string owner = is_class ? block.name : block.member_of;
      if (owner.empty()) continue;
      const bool of_source = name.ends_with(".cpp") && is_defined_here(owner);
      class_lines_[(of_source ? name : folder) + ": " + owner] += block.lines;
    }
  }

  void include_line(const Room& room, const std::string& name, const std::string& place,
                    const std::string& line) {
    static const std::regex kInclude("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
    std::smatch match;
    if (!std::regex_match(line, match, kInclude)) return;
    const std::string target = match[2];
    for (const NamedHere& rule : named_here())
      if (std::regex_match(target, rule.include) &&
          std::none_of(rule.places.begin(), rule.places.end(),
                       [&](const std::string& where) { return name.starts_with(where); }))
        broken_.push_back(place + ": " + rule.library + " is not named here (" + target + ")");
    if (match[1] != "\"") return;
    if (room.path == "idl/" && std::regex_match(target, kGenerated)) return;
    const Room* other = room_of(target);
    if (other == nullptr)
      broken_.push_back(place + ": \"" + target + "\" does not begin at the root of the tree");
    else if (!reach_of(room).contains(other->path))
      broken_.push_back(place + ": " + room.path + " may not include " + other->path + " (" +
                        target + ")");
  }

  void machine_path(const std::string& place, const std::string& line) {
    // Written in two pieces, or this file would break its own rule.
    static const std::regex kPath(std::string("(^|[^A-Za-z0-9_.])/(") + "work|root" + ")/");
    if (std::regex_search(line, kPath))
      broken_.push_back(place + ": names a path of somebody's machine");
  }

  void document_line(const std::string& place, const std::string& line) {
    const auto length = std::count_if(line.begin(), line.end(), [](unsigned char c) {
      return (c & 0xc0U) != 0x80U;  // bytes of UTF-8 that begin a character
    });
    if (length > static_cast<std::ptrdiff_t>(kMostLineLength))
      broken_.push_back(place + ": " + std::to_string(length) + " characters, at most " +
                        std::to_string(kMostLineLength));
  }

  void words(const std::string& name, const std::string& text) {
    const auto most = kMostWords.find(name);
    if (most == kMostWords.end()) return;
    std::istringstream all(text);
    const auto count = static_cast<std::size_t>(std::distance(
        std::istream_iterator<std::string>(all), std::istream_iterator<std::string>()));
    if (count > most->second)
      broken_.push_back(name + ": " + std::to_string(count) + " words, at most " +
                        std::to_string(most->second));
  }

  // What stands between backticks and has a slash is a path from the root, or begins that of a
  // file.
  void places(const std::string& name, const std::string& text) {
    static const std::regex kPlace("`([A-Za-z0-9_.-]+/[A-Za-z0-9_./-]*)`");
    for (auto place = std::sregex_iterator(text.begin(), text.end(), kPlace);
         place != std::sregex_iterator(); ++place) {
      const fs::path path = root_ / (*place)[1].str();
      const bool is_there = fs::exists(path) || fs::exists(path.string() + ".h") ||
                            fs::exists(path.string() + ".cpp");
      if (!is_there && (*place)[1].str()[0] != '.')
        broken_.push_back(name + ": names " + (*place)[1].str() + ", which is not there");
    }
  }

  // The comments of a file as one text, so that a citation may go over two lines.
  static void add_comment(const std::string& line, std::string& comments) {
    const std::size_t at = line.find("//");
    if (at == std::string::npos) return;
    const std::size_t begin = line.find_first_not_of("/< ", at);
    if (begin != std::string::npos) comments.append(line, begin).append(" ");
  }

  // A cited document (of the room, or of the room that is named before it) is there, and has the
  // section that is named behind it.
  void citations(const std::string& name, const std::string& comments) {
    static const std::regex kCited(
        "([A-Za-z0-9_./]*[A-Za-z0-9_]\\.md|README)(, sections? ([0-9]+))?");
    for (auto cited = std::sregex_iterator(comments.begin(), comments.end(), kCited);
         cited != std::sregex_iterator(); ++cited) {
      const std::string document = (*cited)[1] == "README" ? "README.md" : (*cited)[1].str();
      const fs::path found = document_near(name, document);
      if (found.empty())
        broken_.push_back(name + ": cites " + document + ", which is not there");
      else if ((*cited)[3].matched && !has_section(found, (*cited)[3]))
        broken_.push_back(name + ": cites section " + (*cited)[3].str() + " of " +
                          found.lexically_relative(root_).generic_string() + ", which has none");
    }
  }

  // In the folder of the file or one above it, or in common/; empty: nowhere.
  fs::path document_near(const std::string& name, const std::string& document) const {
    for (fs::path folder = (root_ / name).parent_path();; folder = folder.parent_path()) {
      if (fs::exists(folder / document)) return folder / document;
      if (folder == root_) break;
    }
    return fs::exists(root_ / "common" / document) ? root_ / "common" / document : fs::path();
  }

  static bool has_section(const fs::path& document, const std::string& number) {
    std::ifstream in(document);
    std::string line;
    while (std::getline(in, line))
      if (line.starts_with("## " + number + " ")) return true;
    return false;
  }

  fs::path root_;
  const std::set<std::string>& known_long_;
  std::set<std::string> readme_rooms_, long_;
  std::map<std::string, std::size_t> class_lines_;  // by place and name
  std::vector<std::string> broken_;
};

}  // namespace

std::vector<std::string> broken_house_rules(const fs::path& root,
                                            const std::set<std::string>& known_long) {
  return HouseCheck(root, known_long).run();
}

}  // namespace mortise::lint
