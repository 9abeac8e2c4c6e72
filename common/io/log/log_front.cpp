#include "common/io/log/log_front.h"

#include "common/base/hash.h"
#include "common/io/build_info.h"
#include "common/io/log/log_json.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/log_records.h"

namespace mortise::log_front {
namespace {

constexpr const char* kCheck = "check";

std::string check_of(const Values& metadata) {
  ByteWriter bytes;
  for (const auto& [key, value] : metadata) {
    if (key == kCheck) continue;
    bytes.string(key);
    bytes.string(value);
  }
  return content_hash(bytes.bytes());
}

void add_metadata(McapWriter& out, const char* name, Values values) {
  values[kCheck] = check_of(values);
  out.add_metadata(name, values);
}

}  // namespace

bool is_whole(const Values& metadata) {
  const auto check = metadata.find(kCheck);
  return check == metadata.end() || check->second == check_of(metadata);
}

void write(McapWriter& out, const LogHeader& header) {
  using namespace log_layout;
  Values session = {{"format", kFormat},
                    {"session", header.session},
                    {"scenario_name", header.scenario_name},
                    {"part", std::to_string(header.chain.part)}};
  for (std::size_t i = 0; i < header.mesh_of_part.size(); ++i)
    session["mesh_of_part/" + std::to_string(i + 1)] = header.mesh_of_part[i];
  add_metadata(out, kSessionMetadata, std::move(session));
  add_metadata(out, kBuildMetadata, build_info());
  if (header.chain.part > 1)
    add_metadata(out, kChainMetadata,
                 {{"previous", header.chain.previous},
                  {"part", std::to_string(header.chain.part)},
                  {"previous_seal", header.chain.previous_seal}});
  out.add_attachment(kScenarioAttachment, "application/yaml",
                     std::as_bytes(std::span(header.scenario_yaml)), 0);
  for (const auto& [hash, mesh] : header.meshes)
    out.add_attachment(kMeshPrefix + hash, "application/x-mortise-mesh", log_records::encode(*mesh),
                       0);
  if (header.assembly)
    out.add_attachment(kAssemblyPrefix + content_hash(*header.assembly),
                       "application/x-mortise-assembly", *header.assembly, 0);
  for (std::size_t i = 0; i < header.imports.size(); ++i) {
    const std::string json = log_json::encode(header.imports[i]);
    out.add_attachment(kImportPrefix + std::to_string(i + 1), "application/json",
                       std::as_bytes(std::span(json)), 0);
  }
}

}  // namespace mortise::log_front
