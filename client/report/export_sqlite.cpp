#include <sqlite3.h>

#include <memory>

#include "client/report/export_sqlite.h"

namespace mortise {
namespace {

// What engineers ask first. Columns are those of the tables.
constexpr const char* kViews = R"(
CREATE VIEW v_open AS SELECT * FROM clashes WHERE end_tick IS NULL;
CREATE VIEW v_to_review AS SELECT * FROM clashes WHERE class <> 'fake' AND status IN ('new', 'active')
  ORDER BY class = 'real' DESC, margin_mm DESC;
CREATE VIEW v_worst_by_pair AS SELECT part_a, part_b, class, max(overlap_lo_mm) AS overlap_lo_mm,
  real_above_mm, fake_below_mm, margin_mm, explanation FROM clashes GROUP BY part_a, part_b, class;
CREATE VIEW v_by_user AS SELECT user, class, count(*) AS clashes, sum(duration_s) AS seconds
  FROM clashes GROUP BY user, class;
CREATE VIEW v_timeline AS SELECT clash, class, part_a, part_b, begin_s, begin_s + duration_s AS end_s
  FROM clashes ORDER BY begin_s;
)";

std::string name_in_sql(const std::string& name) { return '"' + name + '"'; }

class Database {
 public:
  Status open(const std::filesystem::path& file) {
    sqlite3* handle = nullptr;
    const int code =
        sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr);
    handle_.reset(handle);
    return code == SQLITE_OK ? ok() : failure();
  }

  Status run(const std::string& sql) {
    return sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK
               ? ok()
               : failure();
  }

  Status fill(const Table& table) {
    std::string fields, marks;
    for (const Table::Column& column : table.columns) {
      const char* type = column.type == Table::Type::kText      ? " TEXT"
                         : column.type == Table::Type::kInteger ? " INTEGER"
                                                                : " REAL";
      fields += (fields.empty() ? "" : ", ") + name_in_sql(column.name) + type;
      marks += marks.empty() ? "?" : ", ?";
    }
    const std::string name = name_in_sql(table.name);
    if (const Status made = run("CREATE TABLE " + name + " (" + fields + ")"); !made) return made;
    sqlite3_stmt* raw = nullptr;
    const std::string insert = "INSERT INTO " + name + " VALUES (" + marks + ")";
    if (sqlite3_prepare_v2(handle_.get(), insert.c_str(), -1, &raw, nullptr) != SQLITE_OK)
      return failure();
    const std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)> statement(raw,
                                                                               sqlite3_finalize);
    for (const std::vector<Json>& row : table.rows) {
      for (std::size_t i = 0; i < row.size(); ++i) bind(raw, static_cast<int>(i + 1), row[i]);
      if (sqlite3_step(raw) != SQLITE_DONE) return failure();
      sqlite3_reset(raw);
    }
    return ok();
  }

 private:
  static void bind(sqlite3_stmt* statement, int at, const Json& value) {
    if (value.is_null()) {
      sqlite3_bind_null(statement, at);
    } else if (value.is_string()) {
      const auto& text = value.get_ref<const std::string&>();
      sqlite3_bind_text(statement, at, text.data(), static_cast<int>(text.size()),
                        SQLITE_TRANSIENT);
    } else if (value.is_number_float()) {
      sqlite3_bind_double(statement, at, value.get<double>());
    } else {
      sqlite3_bind_int64(statement, at, value.get<std::int64_t>());
    }
  }

  Status failure() const {
    return fail(Code::kRuntime, std::string("the database: ") + sqlite3_errmsg(handle_.get()));
  }

  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, sqlite3_close};
};

}  // namespace

Status write_sqlite(std::span<const Table> tables, const std::filesystem::path& file) {
  if (std::filesystem::exists(file))
    return fail(Code::kRuntime, file.string() + " exists already: name a new file");
  Database database;
  if (const Status opened = database.open(file); !opened) return opened;
  if (const Status begun = database.run("BEGIN"); !begun) return begun;
  for (const Table& table : tables)
    if (const Status filled = database.fill(table); !filled) return filled;
  if (const Status viewed = database.run(kViews); !viewed) return viewed;
  return database.run("COMMIT");
}

}  // namespace mortise
