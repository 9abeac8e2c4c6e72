#include "common/io/step/step_import.h"

#include <algorithm>
#include <cctype>

#include "common/io/mesh/confined_child.h"
#include "common/io/mesh/sandbox.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

// Processor time that reading may take.
constexpr double kLeastReading_s = 10.0, kReadingOfMB_s = 20.0;
// The importer waits for its last operations after its own limit.
constexpr double kAfterCommons_s = 5.0;

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

ConfinedChild importer_of(const fs::path& file, AfterReading then, const ImportLimits& limits) {
  std::error_code ignored;
  ConfinedChild child;
  child.called = "STEP importer";
  child.where_from =
      "build the target mortise-import-step (it needs the packages of packages-step.txt), install "
      "mortise-step, or set MORTISE_STEP_IMPORTER";
  child.program = program_beside("MORTISE_STEP_IMPORTER", "mortise-import-step");
  child.file = file;
  child.arguments = {then == AfterReading::kEnd ? "read" : "keep",
                     fs::absolute(file, ignored).string()};
  child.limits = limits;
  child.cpu = {kLeastReading_s, kReadingOfMB_s};
  return child;
}

// What the importer said, and the importer where it is kept.
struct Said {
  std::vector<std::byte> bytes;
  std::shared_ptr<ExactSolids> exact;
};

Result<Said> ask_importer(const fs::path& file, AfterReading then, const ImportLimits& limits) {
  const ConfinedChild child = importer_of(file, then, limits);
  if (then == AfterReading::kEnd) {
    const Result<MappedBytes> answer = run_confined(child);
    if (!answer) return answer.error();
    return Said{{answer->bytes().begin(), answer->bytes().end()}, nullptr};
  }
  Result<ConfinedDialogue> dialogue = ConfinedDialogue::start(child);
  if (!dialogue) return dialogue.error();
  Said said{dialogue->take_said(), nullptr};
  said.exact = std::make_shared<ExactSolids>(std::move(*dialogue));
  return said;
}

}  // namespace

bool is_step_name(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".step" || extension == ".stp";
}

Result<StepAssembly> import_step(const fs::path& file, AfterReading then,
                                 const ImportLimits& limits) try {
  if (const std::string no = step_objection(file); !no.empty()) {
    std::error_code ignored;
    return fail(fs::exists(file, ignored) ? Code::kInvalidInput : Code::kNotFound,
                file.string() + ": " + no);
  }
  Result<Said> said = ask_importer(file, then, limits);
  if (!said) return fail(said.error().code, file.string() + ": " + said.error().text);
  Result<StepDocument> document = decode_step(said->bytes);
  if (!document) return fail(document.error().code, file.string() + ": " + document.error().text);
  std::error_code ignored;
  if (document->refusal.find("bad_alloc") != std::string::npos)
    return fail(
        Code::kInvalidInput,
        file.string() + ": reading it needs more than " +
            std::to_string(memory_for(fs::file_size(file, ignored), limits.memory_bytes) >> 20U) +
            " MB of memory; the file is damaged, or too large");
  if (!document->refusal.empty())
    return fail(Code::kInvalidInput, file.string() + ": " + document->refusal);
  return StepAssembly{std::move(*document), std::move(said->bytes), std::move(said->exact)};
} catch (const std::exception& error) {  // memory of our own, names that are no paths
  return fail(Code::kRuntime, file.string() + ": cannot be imported: " + error.what());
}

Result<std::vector<StepCommon>> ExactSolids::commons(std::span<const StepCommonQuery> queries) {
  if (queries.empty()) return std::vector<StepCommon>{};
  const auto answer = importer_.ask(encode(queries), kCommons_s + kAfterCommons_s);
  if (!answer) return answer.error();
  Result<std::vector<StepCommon>> commons = decode_step_commons(*answer);
  if (commons && commons->size() != queries.size())
    return fail(Code::kRuntime, "the STEP importer answered another question");
  return commons;
}

}  // namespace mortise
