#include "client/report/bcf.h"

#include <zip.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <pugixml.hpp>
#include <set>
#include <span>
#include <sstream>

#include "client/report/cells.h"
#include "client/report/pair_groups.h"
#include "common/base/hash.h"
#include "common/base/plain_text.h"
#include "common/messages/names.h"

namespace mortise {
namespace {

constexpr const char* kSystem = "mortise";
// Seen from three times its size away, the place fills a third of the height.
constexpr double kAspectRatio = 1.5, kFieldOfView_deg = 50.0;
// A place of some micrometres is shown with the parts around it.
constexpr double kLeastDistance_mm = 20.0;
constexpr double kMetresPerMm = 1e-3;

// A name-based GUID (version 8, by a rule of our own); the same name gives the same one.
std::string guid_of(const std::string& name) {
  const std::string h = content_hash(std::as_bytes(std::span(name)));
  return h.substr(0, 8) + "-" + h.substr(8, 4) + "-8" + h.substr(13, 3) + "-8" + h.substr(17, 3) +
         "-" + h.substr(20, 12);
}

std::string date_of(std::int64_t time_ns) {
  const std::time_t seconds =
      static_cast<std::time_t>(std::max<std::int64_t>(0, time_ns) / 1'000'000'000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

// XML has no word for control characters, and a field of the format may not be blank.
std::string shown(const std::string& text, const char* otherwise) {
  std::string safe;
  for (const char c : as_utf8(text))
    if (static_cast<unsigned char>(c) >= 0x20 || c == '\n') safe += c;
  return safe.find_first_not_of(" \n") == std::string::npos ? otherwise : safe;
}

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
  parent.append_child(name).text().set(text.c_str());
}

void add_vector(pugi::xml_node parent, const char* name, const Vec3& v) {
  pugi::xml_node node = parent.append_child(name);
  const char* axes[] = {"X", "Y", "Z"};
  for (int i = 0; i < 3; ++i) node.append_child(axes[i]).text().set(v[i]);
}

std::string text_of(const pugi::xml_document& document) {
  std::ostringstream out;
  document.save(out, " ", pugi::format_indent, pugi::encoding_utf8);
  return out.str();
}

class Archive {
 public:
  Status open(const std::filesystem::path& file) {
    file_ = file.string();
    int error = 0;
    zip_.reset(zip_open(file_.c_str(), ZIP_CREATE | ZIP_EXCL, &error));
    if (zip_) return ok();
    zip_error_t reason;
    zip_error_init_with_code(&reason, error);
    const std::string why = zip_error_strerror(&reason);
    zip_error_fini(&reason);
    return fail(Code::kRuntime, file_ + ": " + why);
  }

  // `bytes` has to stay until close().
  Status add(const std::string& name, const std::string& bytes) {
    zip_source_t* source = zip_source_buffer(zip_.get(), bytes.data(), bytes.size(), 0);
    if (source == nullptr || zip_file_add(zip_.get(), name.c_str(), source, ZIP_FL_ENC_UTF_8) < 0) {
      if (source != nullptr) zip_source_free(source);
      return fail(Code::kRuntime, file_ + ": " + zip_strerror(zip_.get()));
    }
    return ok();
  }

  Status close() {
    if (zip_close(zip_.get()) != 0)
      return fail(Code::kRuntime, file_ + ": " + zip_strerror(zip_.get()));
    (void)zip_.release();
    return ok();
  }

 private:
  struct Discard {
    void operator()(zip_t* zip) const { zip_discard(zip); }
  };
  std::string file_;
  std::unique_ptr<zip_t, Discard> zip_;
};

class BcfWriter {
 public:
  explicit BcfWriter(const BcfProject& project) : project_(project) {}

  Status write(const std::filesystem::path& file) {
    pugi::xml_document version, about;
    version.append_child("Version").append_attribute("VersionId") = "3.0";
    pugi::xml_node info = about.append_child("ProjectInfo").append_child("Project");
    info.append_attribute("ProjectId") = guid_of(project_.id).c_str();
    add_text(info, "Name", shown(project_.name, "session"));
    entries_.emplace_back("bcf.version", text_of(version));
    entries_.emplace_back("project.bcfp", text_of(about));
    for (const BcfTopic& of : project_.topics) topic(of);
    entries_.emplace_back("extensions.xml", extensions());
    Archive archive;
    Status status = archive.open(file);
    for (const auto& [name, bytes] : entries_)
      if (status) status = archive.add(name, bytes);
    return status ? archive.close() : status;
  }

 private:
  std::string extensions() const {
    pugi::xml_document document;
    pugi::xml_node all = document.append_child("Extensions");
    const auto list = [&](const char* group, const char* one, const auto& values) {
      pugi::xml_node node = all.append_child(group);
      for (const std::string& value : values) add_text(node, one, value);
    };
    list("TopicTypes", "TopicType", std::vector<std::string>{"Clash"});
    list("TopicStatuses", "TopicStatus", project_.statuses);
    list("Priorities", "Priority", std::vector<std::string>{"high", "normal", "low"});
    list("TopicLabels", "TopicLabel", project_.labels);
    list("Users", "User", users_);
    return text_of(document);
  }

  std::string author(const std::string& user) {
    const std::string name = shown(user, kSystem);
    users_.insert(name);
    return name;
  }

  void add_comment(const BcfComment& of, const std::string& view, pugi::xml_node topic) {
    pugi::xml_node comments = topic.child("Comments");
    if (!comments) comments = topic.append_child("Comments");
    pugi::xml_node comment = comments.append_child("Comment");
    comment.append_attribute("Guid") = guid_of(of.name).c_str();
    add_text(comment, "Date", of.date);
    add_text(comment, "Author", author(of.author));
    add_text(comment, "Comment", shown(of.text, "–"));
    comment.append_child("Viewpoint").append_attribute("Guid") = view.c_str();
  }

  void topic(const BcfTopic& of) {
    const std::string guid = guid_of(of.name), view = guid_of(of.name + "/view");
    pugi::xml_document document;
    pugi::xml_node topic = document.append_child("Markup").append_child("Topic");
    topic.append_attribute("Guid") = guid.c_str();
    topic.append_attribute("ServerAssignedId") = of.number.c_str();
    topic.append_attribute("TopicType") = "Clash";
    topic.append_attribute("TopicStatus") = shown(of.status, "new").c_str();
    add_text(topic, "Title", shown(of.title, "clash"));
    add_text(topic, "Priority", of.priority);
    add_text(topic.append_child("Labels"), "Label", of.label);
    add_text(topic, "CreationDate", of.date);
    add_text(topic, "CreationAuthor", author(of.author));
    add_text(topic, "Description", shown(of.description, "no explanation"));
    for (const BcfComment& comment : of.comments) add_comment(comment, view, topic);
    pugi::xml_node viewpoint = topic.append_child("Viewpoints").append_child("ViewPoint");
    viewpoint.append_attribute("Guid") = view.c_str();
    add_text(viewpoint, "Viewpoint", "viewpoint.bcfv");
    if (!of.png.empty()) {
      add_text(viewpoint, "Snapshot", "snapshot.png");
      entries_.emplace_back(guid + "/snapshot.png", of.png);
    }
    entries_.emplace_back(guid + "/markup.bcf", text_of(document));
    entries_.emplace_back(guid + "/viewpoint.bcfv", viewpoint_of(of, view));
  }

  static std::string viewpoint_of(const BcfTopic& of, const std::string& guid) {
    pugi::xml_document document;
    pugi::xml_node info = document.append_child("VisualizationInfo");
    info.append_attribute("Guid") = guid.c_str();
    pugi::xml_node components = info.append_child("Components");
    pugi::xml_node selection = components.append_child("Selection");
    for (const std::string& part : of.parts) {
      pugi::xml_node component = selection.append_child("Component");
      add_text(component, "OriginatingSystem", kSystem);
      add_text(component, "AuthoringToolId", shown(part, "part"));
    }
    components.append_child("Visibility").append_attribute("DefaultVisibility") = "true";
    // From beside the place where the two meet, so that neither hides it.
    const Vec3& n = of.normal_W;
    Vec3 side = n.cross(std::fabs(n.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()) + 0.5 * n;
    side = side.norm() > 1e-6 ? Vec3(side.normalized()) : Vec3(1.0, 0.0, 0.0);
    Vec3 up = std::fabs(side.z()) < 0.95 ? Vec3::UnitZ() : Vec3::UnitY();
    up = (up - up.dot(side) * side).normalized();
    const double distance_mm = std::max(kLeastDistance_mm, 3.0 * of.size_mm);
    pugi::xml_node camera = info.append_child("PerspectiveCamera");
    add_vector(camera, "CameraViewPoint", kMetresPerMm * (of.point_W + distance_mm * side));
    add_vector(camera, "CameraDirection", -side);
    add_vector(camera, "CameraUpVector", up);
    camera.append_child("FieldOfView").text().set(kFieldOfView_deg);
    camera.append_child("AspectRatio").text().set(kAspectRatio);
    return text_of(document);
  }

  const BcfProject& project_;
  std::vector<std::pair<std::string, std::string>> entries_;  // name in the archive, bytes
  std::set<std::string> users_ = {kSystem};
};

// The clashes of a session as topics.
class SessionTopics {
 public:
  SessionTopics(const SessionReport& report, const SessionLog& log) : report_(report), log_(log) {}

  BcfProject run() {
    BcfProject project;
    project.id = log_.session + log_.scenario_name;
    project.name = log_.session;
    for (std::uint8_t i = 0; i < kReviewStatusCount; ++i)
      project.statuses.emplace_back(name_of(static_cast<ReviewStatus>(i)));
    project.labels = {"real", "potential", "fake"};
    const Table& clashes = table_named(report_.tables, "clashes");
    for (const PairGroup& group : pair_groups(clashes))
      project.topics.push_back(topic(clashes, group));
    return project;
  }

 private:
  std::int64_t time_of(std::uint64_t tick) const {
    const auto at =
        std::lower_bound(log_.ticks.begin(), log_.ticks.end(), tick,
                         [](const TickRecord& record, std::uint64_t t) { return record.tick < t; });
    return at == log_.ticks.end() ? 0 : at->time_ns;
  }

  std::string name_of_clash(std::uint64_t number) const {
    return log_.session + "/" + std::to_string(time_of(0)) + "/" + log_.scenario_name + "/" +
           std::to_string(number);
  }

  void add_comment(const Cells& clash, BcfTopic& topic) const {
    if (clash.raw("comment").empty()) return;
    topic.comments.push_back({name_of_clash(clash["clash"].get<std::uint64_t>()) + "/comment",
                              date_of(time_of(clash["begin_tick"].get<std::uint64_t>())),
                              clash.raw("status_by"), clash.raw("comment")});
  }

  // A pair of parts: what its worst place is, and how many more there are.
  BcfTopic topic(const Table& clashes, const PairGroup& group) const {
    const Cells clash(clashes, clashes.rows[group.lead]);
    const auto number = clash["clash"].get<std::uint64_t>();
    // The first clash of the pair names the topic, so that it stays the same when another gets
    // worse.
    std::uint64_t first = number;
    for (const std::size_t row : group.others)
      first = std::min(first, Cells(clashes, clashes.rows[row])["clash"].get<std::uint64_t>());
    const std::string klass = shown(clash.raw("class"), "none"), also = also_text(group);
    BcfTopic topic;
    topic.name = name_of_clash(first);
    topic.number = std::to_string(number);
    topic.status = clash.raw("status");
    topic.title = klass + ": " + clash.raw("part_a") + " × " + clash.raw("part_b") +
                  (also.empty() ? "" : " (" + also + ")");
    topic.priority = bcf_priority(klass);
    topic.label = klass;
    topic.date = date_of(time_of(clash["begin_tick"].get<std::uint64_t>()));
    topic.author = clash.raw("user");
    topic.description = clash.raw("explanation");
    topic.parts = {clash.raw("part_a"), clash.raw("part_b")};
    add_comment(clash, topic);
    for (const std::size_t row : group.others)
      add_comment(Cells(clashes, clashes.rows[row]), topic);
    const auto picture = report_.pictures.png_of_clash.find(number);
    if (picture != report_.pictures.png_of_clash.end()) topic.png = picture->second;
    const auto vector = [&](const char* x, const char* y, const char* z) {
      const Vec3 v(clash.number(x), clash.number(y), clash.number(z));
      return v.allFinite() ? v : Vec3(Vec3::Zero());
    };
    topic.point_W = vector("x_mm", "y_mm", "z_mm");
    topic.normal_W = vector("normal_x", "normal_y", "normal_z");
    const auto touch = report_.pictures.touches.find(number);
    if (touch != report_.pictures.touches.end()) topic.size_mm = touch->second.size_mm;
    return topic;
  }

  const SessionReport& report_;
  const SessionLog& log_;
};

}  // namespace

std::string bcf_priority(const std::string& klass) {
  return klass == "real" ? "high" : klass == "potential" ? "normal" : "low";
}

Status write_bcf(const BcfProject& project, const std::filesystem::path& file) {
  return BcfWriter(project).write(file);
}

Status write_bcf(const SessionReport& report, const SessionLog& log,
                 const std::filesystem::path& file) {
  return write_bcf(SessionTopics(report, log).run(), file);
}

}  // namespace mortise
