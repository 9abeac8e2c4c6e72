#include <fstream>

#include "client/report/export_files.h"

#include "common/base/plain_text.h"

namespace mortise {
namespace {

std::string field_of(const Json& value) {
  if (value.is_null()) return "";
  if (!value.is_string()) return value.dump();
  std::string text = as_utf8(value.get_ref<const std::string&>());
  // Names and comments come from people. A spreadsheet computes what begins like this.
  if (!text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos)
    text.insert(0, 1, '\'');
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  quoted.push_back('"');
  return quoted;
}

}  // namespace

Json json_of(std::span<const Table> tables) {
  Json document;
  for (const Table& table : tables) {
    Json& rows = document["tables"][table.name] = Json::array();
    for (const std::vector<Json>& row : table.rows) {
      Json& object = rows.emplace_back(Json::object());
      for (std::size_t i = 0; i < row.size(); ++i) object[table.columns[i].name] = row[i];
    }
  }
  return document;
}

std::string csv_of(const Table& table) {
  std::string text;
  const auto line = [&](auto&& field) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (i > 0) text.push_back(',');
      text.append(field(i));
    }
    text.append("\r\n");
  };
  line([&](std::size_t i) { return table.columns[i].name; });
  for (const std::vector<Json>& row : table.rows)
    line([&](std::size_t i) { return field_of(row[i]); });
  return text;
}

Status write_csv(std::span<const Table> tables, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(Code::kRuntime, folder.string() + ": " + error.message());
  for (const Table& table : tables) {
    const std::filesystem::path file = folder / (table.name + ".csv");
    std::ofstream out(file, std::ios::binary);
    out << csv_of(table);
    if (!out.flush()) return fail(Code::kRuntime, file.string() + " could not be written");
  }
  return ok();
}

}  // namespace mortise
