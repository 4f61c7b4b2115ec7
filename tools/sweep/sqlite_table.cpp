#include "tools/sweep/sqlite_table.h"

#include <sqlite3.h>

#include <memory>
#include <stdexcept>

namespace beampipe {
namespace {

std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

// A database in memory. It becomes a file when it is complete, so that no lock on a shared file system is needed.
class Database {
 public:
  Database() {
    sqlite3* opened = nullptr;
    const int code = sqlite3_open(":memory:", &opened);
    database_.reset(opened);
    if (code != SQLITE_OK) fail();
  }

  void run(const std::string& sql) {
    if (sqlite3_exec(database_.get(), sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
  }

  // Inserts rows; each(insert) calls insert(values) for every one of them.
  template <class Each>
  void insert(const std::string& sql, Each&& each) {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database_.get(), sql.c_str(), -1, &prepared, nullptr) != SQLITE_OK) fail();
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, sqlite3_finalize);
    each([&](const std::vector<Json>& values) {
      for (std::size_t i = 0; i < values.size(); ++i) bind(prepared, static_cast<int>(i + 1), values[i]);
      if (sqlite3_step(prepared) != SQLITE_DONE) fail();
      sqlite3_reset(prepared);
    });
  }

  std::string bytes() const {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> data(sqlite3_serialize(database_.get(), "main", &size, 0),
                                                               sqlite3_free);
    if (!data) throw std::runtime_error("table.sqlite: out of memory");
    return {reinterpret_cast<const char*>(data.get()), static_cast<std::size_t>(size)};
  }

 private:
  void bind(sqlite3_stmt* statement, int at, const Json& value) {
    int code = SQLITE_OK;
    if (value.is_string()) {
      const std::string text = value.get<std::string>();
      code = sqlite3_bind_text(statement, at, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
    } else if (value.is_integer()) {
      code = sqlite3_bind_int64(statement, at, value.get<std::int64_t>());
    } else if (value.is_number()) {
      code = sqlite3_bind_double(statement, at, value.get<double>());
    } else {
      code = sqlite3_bind_null(statement, at);
    }
    if (code != SQLITE_OK) fail();
  }

  [[noreturn]] void fail() const {
    throw std::runtime_error(std::string("table.sqlite: ") + sqlite3_errmsg(database_.get()));
  }

  std::unique_ptr<sqlite3, int (*)(sqlite3*)> database_{nullptr, sqlite3_close};
};

}  // namespace

std::string sqlite_bytes(const SweepTable& table) {
  Database database;
  std::string columns, places;
  for (const SweepColumn& column : table.columns) {
    columns += (columns.empty() ? "" : ", ") + quoted(column.name) + (column.is_text ? " TEXT" : " NUMERIC");
    places += places.empty() ? "?" : ", ?";
  }
  database.run("CREATE TABLE cells (" + columns +
               "); CREATE TABLE columns (name TEXT, unit TEXT, meaning TEXT); BEGIN");
  database.insert("INSERT INTO columns VALUES (?, ?, ?)", [&](auto&& insert) {
    for (const SweepColumn& column : table.columns) insert({column.name, column.unit, column.meaning});
  });
  database.insert("INSERT INTO cells VALUES (" + places + ")", [&](auto&& insert) {
    for (const std::vector<Json>& row : table.rows) insert(row);
  });
  database.run("COMMIT");
  return database.bytes();
}

}  // namespace beampipe
