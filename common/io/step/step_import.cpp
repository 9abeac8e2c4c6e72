#include "common/io/step/step_import.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/io/mesh/confined_child.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// Empty when the file may be given to the importer.
std::string step_objection(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) return "there is no such file; paths start at the scenario, or here";
  if (fs::is_directory(status)) return "is a folder; name a STEP file in it";
  if (!fs::is_regular_file(status)) return "this is not a regular file";
  if (fs::file_size(file, error) == 0) return "the file is empty; export it again";
  return {};
}

// Ten times the processor that reading takes: a small file that hangs the reader ends soon.
double processor_seconds(const fs::path& file, const ImportLimits& limits) {
  std::error_code error;
  const double megabytes = static_cast<double>(fs::file_size(file, error)) / (1 << 20);
  return std::min(error ? 15.0 : 15.0 + 5.0 * megabytes, std::clamp(limits.seconds, 0.0, 1e6));
}

Result<MappedBytes> ask_importer(const fs::path& file, const std::string& what,
                                 const ImportLimits& limits, std::span<const std::byte> question) {
  std::error_code ignored;
  ConfinedChild child;
  child.called = "STEP importer";
  child.where_from =
      "build the target mortise-import-step (it needs the packages of packages-step.txt), install "
      "mortise-step, or set MORTISE_STEP_IMPORTER";
  child.program = program_beside("MORTISE_STEP_IMPORTER", "mortise-import-step");
  child.arguments = {what, fs::absolute(file, ignored).string(),
                     std::to_string(limits.memory_bytes),
                     std::to_string(std::llround(std::ceil(processor_seconds(file, limits))))};
  child.limits = limits;
  child.question = question;
  return run_confined(child);
}

}  // namespace

bool is_step_name(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".step" || extension == ".stp";
}

Result<StepAssembly> import_step(const fs::path& file, const ImportLimits& limits) try {
  if (const std::string no = step_objection(file); !no.empty()) {
    std::error_code ignored;
    return fail(fs::exists(file, ignored) ? Code::kInvalidInput : Code::kNotFound,
                file.string() + ": " + no);
  }
  const Result<MappedBytes> answer = ask_importer(file, "read", limits, {});
  if (!answer) return fail(answer.error().code, file.string() + ": " + answer.error().text);
  Result<StepDocument> document = decode_step(answer->bytes());
  if (!document) return fail(document.error().code, file.string() + ": " + document.error().text);
  if (document->refusal.find("bad_alloc") != std::string::npos)
    return fail(Code::kInvalidInput, file.string() + ": reading it needs more than " +
                                         std::to_string(limits.memory_bytes >> 20U) +
                                         " MB of memory; the file is damaged, or too large");
  if (!document->refusal.empty())
    return fail(Code::kInvalidInput, file.string() + ": " + document->refusal);
  const auto bytes = answer->bytes();
  return StepAssembly{std::move(*document), {bytes.begin(), bytes.end()}};
} catch (const std::exception& error) {  // memory of our own, names that are no paths
  return fail(Code::kRuntime, file.string() + ": cannot be imported: " + error.what());
}

Result<std::vector<StepCommon>> step_commons(const fs::path& file,
                                             std::span<const StepCommonQuery> queries,
                                             const ImportLimits& limits) {
  if (queries.empty()) return std::vector<StepCommon>{};
  const Result<MappedBytes> answer = ask_importer(file, "common", limits, encode(queries));
  if (!answer) return fail(answer.error().code, file.string() + ": " + answer.error().text);
  Result<std::vector<StepCommon>> commons = decode_step_commons(answer->bytes());
  if (commons && commons->size() != queries.size())
    return fail(Code::kRuntime, file.string() + ": the importer answered another question");
  return commons;
}

}  // namespace mortise
