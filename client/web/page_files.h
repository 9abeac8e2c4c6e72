#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "client/web/frames.h"
#include "common/base/result.h"

namespace mortise::web {

/// A file as it is served.
struct PageFile {
  SharedBytes bytes;
  std::string type;  ///< MIME
  std::string etag;
  bool is_page = false;  ///< index.html: gets a content security policy
};

/// The files of the page. They are read anew at each request, so that an edit shows at the next
/// load.
class PageFiles {
 public:
  /// Fails when there is no index.html.
  static Result<PageFiles> open(const std::filesystem::path& folder);

  /// The file that a target of a request ("/", "/main.js?x") stands for; nothing unless it is a
  /// plain file below the folder whose name and kind may be served. Of node_modules only three.js,
  /// as /three/build/... and /three/examples/jsm/...
  std::optional<PageFile> find(std::string_view target) const;

  bool has_three() const;
  const std::filesystem::path& folder() const { return folder_; }

 private:
  explicit PageFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::filesystem::path folder_;  ///< canonical
};

/// The policy of the page: everything from its own origin, and the one inline script that may be,
/// its import map, by its hash.
std::string content_security_policy(std::string_view page, std::string_view host, bool tls);

}  // namespace mortise::web
