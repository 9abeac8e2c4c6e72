#include "client/web/page_files.h"

#include <openssl/evp.h>
#include <openssl/sha.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <vector>

namespace mortise::web {
namespace {

namespace fs = std::filesystem;

// A file is held in memory while it is sent. The largest of the page, of three.js, has 1.5 MB.
constexpr std::uintmax_t kLargestFile = 32u << 20;

// What is not in here is not served.
constexpr std::array<std::pair<std::string_view, std::string_view>, 12> kTypes = {{
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".wasm", "application/wasm"},
    {".txt", "text/plain; charset=utf-8"},
}};

// No dot at the front, no '%', no backslash, nothing empty: nothing can lead out of the folder.
bool is_plain(std::string_view segment) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.";
  return !segment.empty() && segment.front() != '.' &&
         segment.find_first_not_of(kLetters) == std::string_view::npos;
}

// Segments of the path of a target; empty when one of them is not plain.
std::vector<std::string> segments_of(std::string_view path) {
  std::vector<std::string> segments;
  while (!path.empty()) {
    path.remove_prefix(1);  // '/'
    const std::string_view segment = path.substr(0, path.find('/'));
    if (!is_plain(segment)) return {};
    segments.emplace_back(segment);
    path.remove_prefix(segment.size());
  }
  return segments;
}

bool is_served_three(const std::vector<std::string>& segments) {
  return segments.size() >= 3 &&
         (segments[1] == "build" || (segments[1] == "examples" && segments[2] == "jsm"));
}

std::optional<std::string> read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  std::ostringstream text;
  text << in.rdbuf();
  return std::move(text).str();
}

std::string etag_of(const struct stat& status) {
  std::ostringstream text;
  text << '"' << std::hex << status.st_size << '-' << status.st_mtim.tv_sec << '.'
       << status.st_mtim.tv_nsec << '"';
  return text.str();
}

std::string base64_sha256(std::string_view text) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data());
  std::array<unsigned char, 4 * (SHA256_DIGEST_LENGTH / 3 + 1) + 1> out;
  const int size = EVP_EncodeBlock(out.data(), digest.data(), static_cast<int>(digest.size()));
  return {reinterpret_cast<const char*>(out.data()), static_cast<std::size_t>(size)};
}

// What stands between <script type="importmap"> and its end; empty without one.
std::string_view import_map_of(std::string_view page) {
  constexpr std::string_view kBegin = "<script type=\"importmap\">", kEnd = "</script>";
  const std::size_t begin = page.find(kBegin);
  if (begin == std::string_view::npos) return {};
  page.remove_prefix(begin + kBegin.size());
  return page.substr(0, page.find(kEnd));
}

}  // namespace

Result<PageFiles> PageFiles::open(const fs::path& folder) {
  std::error_code error;
  const fs::path canonical = fs::canonical(folder, error);
  if (error || !fs::is_regular_file(canonical / "index.html", error)) {
    return fail(Code::kNotFound,
                folder.string() + ": no index.html of the page there; name its folder by --page");
  }
  return PageFiles(canonical);
}

bool PageFiles::has_three() const {
  std::error_code error;
  return fs::is_regular_file(folder_ / "node_modules/three/build/three.module.js", error);
}

std::optional<PageFile> PageFiles::find(std::string_view target) const {
  const std::string_view path = target.substr(0, target.find('?'));
  std::vector<std::string> segments = segments_of(path == "/" ? "/index.html" : path);
  if (segments.empty()) return std::nullopt;
  fs::path file = folder_;
  if (segments.front() == "three") {
    if (!is_served_three(segments)) return std::nullopt;
    file /= "node_modules";
  } else if (segments.front() == "node_modules" || segments.front().starts_with("package")) {
    return std::nullopt;
  }
  for (const std::string& segment : segments) file /= segment;
  const std::string ending = file.extension().string();
  const auto* const type = std::find_if(kTypes.begin(), kTypes.end(),
                                        [&](const auto& row) { return row.first == ending; });
  if (type == kTypes.end()) return std::nullopt;
  // A link may lead out, even though the names do not.
  std::error_code error;
  const fs::path real = fs::canonical(file, error);
  struct stat status;
  if (error || ::stat(real.c_str(), &status) != 0 || !S_ISREG(status.st_mode) ||
      static_cast<std::uintmax_t>(status.st_size) > kLargestFile ||
      !real.string().starts_with(folder_.string() + "/")) {
    return std::nullopt;
  }
  auto text = read_file(real);
  if (!text) return std::nullopt;
  return PageFile{std::make_shared<const std::string>(std::move(*text)), std::string(type->second),
                  etag_of(status), segments.back() == "index.html"};
}

std::string content_security_policy(std::string_view page, std::string_view host, bool tls) {
  const std::string_view import_map = import_map_of(page);
  std::string scripts = "'self'";
  if (!import_map.empty()) scripts += " 'sha256-" + base64_sha256(import_map) + "'";
  return "default-src 'none'; script-src " + scripts +
         "; style-src 'self'; img-src 'self' data: blob:; font-src 'self'; connect-src 'self' " +
         (tls ? "wss://" : "ws://") + std::string(host) +
         "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

}  // namespace mortise::web
