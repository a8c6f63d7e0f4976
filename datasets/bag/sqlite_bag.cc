// What rosbag2 writes with its storage plugin sqlite3: tables `topics` and `messages`, and since Iron
// `message_definitions`.
#include <sqlite3.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "datasets/bag/container.h"
#include "datasets/bag/unpack.h"
#include "datasets/bag/window_file.h"
#include "schema/error.h"
#include "schema/store/regular_file.h"
#include "schema/text.h"

namespace cairn::datasets::bag {
namespace {

struct FinalizeQuery {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Query = std::unique_ptr<sqlite3_stmt, FinalizeQuery>;

struct CloseDatabase {
  void operator()(sqlite3* db) const { sqlite3_close(db); }
};

std::string TextOf(sqlite3_stmt* statement, int column) {
  const auto* text = sqlite3_column_text(statement, column);
  if (text == nullptr) return {};
  return {reinterpret_cast<const char*>(text),
          static_cast<std::size_t>(sqlite3_column_bytes(statement, column))};
}

// For a URI: what is not a plain character of a path, as %XX.
std::string UriOf(const std::string& path) {
  std::string uri = "file:";
  for (const char c : path) {
    constexpr std::string_view kPlain = "/-_.~";
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || kPlain.find(c) != std::string_view::npos) {
      uri += c;
      continue;
    }
    constexpr const char* kHex = "0123456789ABCDEF";
    uri += {'%', kHex[static_cast<unsigned char>(c) >> 4], kHex[static_cast<unsigned char>(c) & 15]};
  }
  return uri;
}

class SqliteBag : public Container {
 public:
  explicit SqliteBag(const std::string& path) : Container(path) {
    Open();
    for (const char* table : {"topics", "messages"})
      if (!HasTable(table))
        throw InputError(path + ": an SQLite file without a table '" + table + "': none of rosbag2's");
    ReadTopics();
    CountMessages();
  }

  std::string what() const override { return "a ROS 2 bag in SQLite"; }

  void ReadMessages(const std::vector<bool>& wanted, const Take& take, const Broken& broken) override {
    try {
      // By hand and not by SQL which of them: their bytes lie on other pages, which are not read.
      const Query query = Prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY rowid");
      while (Next(query.get())) {
        const auto channel = topics_.find(sqlite3_column_int64(query.get(), 0));
        if (channel == topics_.end() || !wanted[channel->second]) continue;
        take({channel->second, 0, sqlite3_column_int64(query.get(), 1), BytesOf(query.get(), 2)});
      }
    } catch (const Damage& damage) {
      broken(damage.what);
    }
  }

 private:
  void Open() {
    // A FIFO, a device or a folder is none of SQLite's.
    if (const Result<RegularFile> file = RegularFile::Open(path()); !file.ok())
      throw InputError(file.status().message());
    std::error_code error;
    // A recorder that was cut off leaves what it wrote last in a file beside it; without one, the file is not
    // locked, and nothing is written beside it.
    pending_ = std::filesystem::exists(path() + "-wal", error);
    const std::string uri = UriOf(path()) + (pending_ ? "?mode=ro" : "?mode=ro&immutable=1");
    sqlite3* opened = nullptr;
    const int code = sqlite3_open_v2(uri.c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    db_.reset(opened);
    if (code != SQLITE_OK) throw InputError(path() + ": cannot be opened: " + sqlite3_errstr(code));
    // SQLite takes a file that ends before its last page for none, but of those who may mend it.
    const bool is_cut = !pending_ && EndsBeforeItsLastPage();
    if (is_cut) remarks_.emplace_back("the file ends within it");
    for (const auto& [option, on] : {std::pair{SQLITE_DBCONFIG_DEFENSIVE, is_cut ? 0 : 1},
                                     {SQLITE_DBCONFIG_WRITABLE_SCHEMA, is_cut ? 1 : 0},
                                     {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                     {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                     {SQLITE_DBCONFIG_ENABLE_VIEW, 0}})
      sqlite3_db_config(opened, option, on, nullptr);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(kMostRecordBytes));
    LimitSteps();
  }

  // By its header (https://www.sqlite.org/fileformat2.html#the_database_header), where that counts the pages.
  bool EndsBeforeItsLastPage() const {
    constexpr std::size_t kPageBytesAt = 16, kChangedAt = 24, kPagesAt = 28, kCountedAt = 92, kBytes = 100;
    std::array<unsigned char, kBytes> header{};
    const Result<RegularFile> file = RegularFile::Open(path());
    if (!file.ok() || file.value().ReadAt(std::as_writable_bytes(std::span(header)), 0) != 0) return false;
    const auto number = [&](std::size_t at, std::size_t bytes) {
      std::uint64_t value = 0;
      for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | header.at(at + i);
      return value;
    };
    const std::uint64_t page_bytes = number(kPageBytesAt, 2) == 1 ? 65536 : number(kPageBytesAt, 2);
    return number(kChangedAt, 4) == number(kCountedAt, 4) &&
           file.value().size() < number(kPagesAt, 4) * page_bytes;
  }

  // Pages that name each other in a circle would be read for ever. Each step of SQLite's machine reads no
  // more than a page or so; a row takes some ten.
  void LimitSteps() {
    constexpr int kPortion = 10'000;
    constexpr std::uint64_t kLeastSteps = 100'000'000;
    std::error_code error;
    const std::uint64_t bytes = std::filesystem::file_size(path(), error);
    portions_ = (kLeastSteps + (error ? 0 : bytes)) / kPortion;
    const auto count_down = [](void* left) {
      auto& portions = *static_cast<std::uint64_t*>(left);
      if (portions == 0) return 1;
      --portions;
      return 0;
    };
    sqlite3_progress_handler(db_.get(), kPortion, count_down, &portions_);
  }

  Query Prepare(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) Fail();
    return Query(statement);
  }

  bool Next(sqlite3_stmt* statement) {
    const int code = sqlite3_step(statement);
    if (code == SQLITE_ROW) return true;
    if (code != SQLITE_DONE) Fail();
    return false;
  }

  [[noreturn]] void Fail() {
    if (pending_ && sqlite3_errcode(db_.get()) == SQLITE_CANTOPEN)
      throw Damage{"what was recorded last lies in '" + path() +
                   "-wal', which SQLite reads only where it may write beside it: copy both files to a folder "
                   "where you may"};
    throw Damage{"SQLite: " + Printable(sqlite3_errmsg(db_.get()), 200)};
  }

  // A view of that name may be of endless rows.
  bool HasTable(const char* name) {
    const Query query =
        Prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?1 AND rootpage > 0");
    sqlite3_bind_text(query.get(), 1, name, -1, SQLITE_STATIC);
    return Next(query.get());
  }

  bool HasColumn(const char* table, const char* column) {
    const Query query = Prepare("SELECT 1 FROM pragma_table_info(?1) WHERE name = ?2");
    sqlite3_bind_text(query.get(), 1, table, -1, SQLITE_STATIC);
    sqlite3_bind_text(query.get(), 2, column, -1, SQLITE_STATIC);
    return Next(query.get());
  }

  void ReadTopics() {
    std::map<std::string, std::string_view> definitions;
    if (HasTable("message_definitions")) {
      const Query query =
          Prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
      while (Next(query.get()))
        if (TextOf(query.get(), 1) == "ros2msg")
          definitions[TextOf(query.get(), 0)] = Keep(TextOf(query.get(), 2));
    }
    const Query query = Prepare("SELECT id, name, type, serialization_format FROM topics");
    while (Next(query.get())) {
      Channel channel;
      channel.topic = TextOf(query.get(), 1);
      const std::string type = TextOf(query.get(), 2);
      channel.type = TypeName(type);
      channel.encoding = TextOf(query.get(), 3);
      channel.wire = channel.encoding == "cdr" ? Wire::kCdr : Wire::kOther;
      if (const auto found = definitions.find(type); found != definitions.end())
        channel.definition = found->second;
      topics_[sqlite3_column_int64(query.get(), 0)] = FindOrAdd(std::move(channel));
    }
  }

  void CountMessages() {
    try {
      const Query query = Prepare(
          "SELECT topic_id, COUNT(*), MIN(timestamp), MAX(timestamp) FROM messages GROUP BY topic_id");
      while (Next(query.get())) {
        const auto channel = topics_.find(sqlite3_column_int64(query.get(), 0));
        if (channel == topics_.end()) continue;
        Count(channel->second, static_cast<std::uint64_t>(sqlite3_column_int64(query.get(), 1)));
        Cover(sqlite3_column_int64(query.get(), 2), sqlite3_column_int64(query.get(), 3));
      }
    } catch (const Damage&) {
      remarks_.emplace_back("its messages are counted as far as they can be read: the file is damaged");
      CountOneByOne();
    }
  }
  void CountOneByOne() {
    try {
      const Query query = Prepare("SELECT topic_id, timestamp FROM messages ORDER BY rowid");
      while (Next(query.get())) {
        const auto channel = topics_.find(sqlite3_column_int64(query.get(), 0));
        if (channel == topics_.end()) continue;
        Count(channel->second, 1);
        Cover(sqlite3_column_int64(query.get(), 1), sqlite3_column_int64(query.get(), 1));
      }
    } catch (const Damage&) {  // who reads them is told
    }
  }

  // rosbag2 packs each message by itself where it is told so (compression_mode: message).
  ByteSpan BytesOf(sqlite3_stmt* statement, int column) {
    const ByteSpan bytes(static_cast<const std::byte*>(sqlite3_column_blob(statement, column)),
                         static_cast<std::size_t>(sqlite3_column_bytes(statement, column)));
    return AsText(bytes).starts_with("\x28\xB5\x2F\xFD") ? unpacker_.UnpackZstd(bytes) : bytes;
  }

  std::unique_ptr<sqlite3, CloseDatabase> db_;
  bool pending_ = false;  // a part of it lies in another file
  std::uint64_t portions_ = 0;
  std::map<std::int64_t, std::size_t> topics_;  // their channels
  Unpacker unpacker_;
};

}  // namespace

std::unique_ptr<Container> OpenSqliteBag(const std::string& path) {
  return std::make_unique<SqliteBag>(path);
}

}  // namespace cairn::datasets::bag
