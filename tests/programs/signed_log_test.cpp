// mortise-replay verify --signed: whatever is done to a signed log shows.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "common/io/log/crc32.h"
#include "common/io/log/log_seal_check.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/session_log_read.h"
#include "idl/identity.h"
#include "tests/golden/played_session.h"
#include "tests/network/key_ring.h"
#include "tests/support/programs.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;

/// A record of a file: where it begins, and where the next one does.
struct RecordPlace {
  std::uint8_t opcode = 0;
  std::size_t from = 0, to = 0;
};

std::vector<RecordPlace> records_of(const std::string& bytes) {
  std::vector<RecordPlace> records;
  for (std::size_t at = mcap::kMagic.size(); at + mcap::kRecordHeaderBytes <= bytes.size();) {
    std::uint64_t length = 0;
    for (std::size_t i = 8; i > 0; --i)
      length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
    const std::size_t to = at + mcap::kRecordHeaderBytes + length;
    if (to > bytes.size()) break;
    records.push_back({static_cast<std::uint8_t>(bytes[at]), at, to});
    at = to;
  }
  return records;
}

class SignedLog : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    site_ = std::make_unique<test::KeyRing>("keys");
    site_->issue("hall", "server");
    site_->issue("anna", "designer");
    site_->issue("gone", "server");
    const std::string folder = std::string(MORTISE_SOURCE_DIR) + "/scenarios/thin_wall";
    auto session = test::play_session(folder + ".yaml", folder + ".play.yaml");
    ASSERT_TRUE(session) << session.error().text;
    session_ = std::make_unique<test::PlayedSession>(std::move(*session));
    ASSERT_EQ(site_->trouble(), "");
  }
  static void TearDownTestSuite() {
    session_.reset();
    site_.reset();
  }
  void SetUp() override { ASSERT_NE(session_, nullptr); }

  fs::path file(const std::string& name) const { return folder_.path() / name; }
  void write(const fs::path& log, const std::string& signer) const {
    LogOptions options{.chunk_bytes = 1024};
    if (!signer.empty()) {
      const KeyFiles keys((*site_)[signer]);
      auto own = LogSigner::open(keys.certificate, keys.key);
      ASSERT_TRUE(own) << own.error().text;
      options.signer = std::move(*own);
    }
    auto writer = SessionLogWriter::create(log, session_->header, options);
    ASSERT_TRUE(writer) << writer.error().text;
    for (const TickRecord& tick : session_->ticks) (*writer)->record(tick);
    ASSERT_TRUE((*writer)->close());
  }
  std::string written(const std::string& signer) const {
    const fs::path log = file("whole.mcap");
    fs::remove(log);
    write(log, signer);
    std::ifstream in(log, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// The exit code, and what was said, of a log of these bytes.
  test::Outcome verify(const std::string& bytes, const std::string& site = {}) const {
    std::ofstream(file("log.mcap"), std::ios::binary) << bytes;
    const std::string trusted = site.empty() ? (*site_)["anna"] : site;
    return test::run("mortise-replay",
                     "verify --signed '" + trusted + "' '" + file("log.mcap").string() + "'");
  }
  void expect_found(const std::string& bytes, const std::string& words) const {
    const test::Outcome outcome = verify(bytes);
    EXPECT_EQ(outcome.exit_code, 4) << outcome.out;
    EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
  }

  static inline std::unique_ptr<test::KeyRing> site_;
  static inline std::unique_ptr<test::PlayedSession> session_;
  test::TestFolder folder_;
};

TEST_F(SignedLog, AWholeOneIsProven) {
  const test::Outcome outcome = verify(written("hall"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out;
  EXPECT_NE(outcome.out.find("signed, and unchanged since"), std::string::npos) << outcome.out;
}

TEST_F(SignedLog, FlippedDroppedReorderedCutAndAppendedChunksAreFound) {
  const std::string whole = written("hall");
  std::vector<RecordPlace> chunks;
  for (const RecordPlace& record : records_of(whole)) {
    if (record.opcode == mcap::kDataEnd) break;
    if (record.opcode == mcap::kChunk) chunks.push_back(record);
  }
  ASSERT_GT(chunks.size(), 4U);
  const auto text = [&](const RecordPlace& r) { return whole.substr(r.from, r.to - r.from); };
  const RecordPlace &a = chunks[1], &b = chunks[2];

  std::string flipped = whole;
  flipped[(a.from + a.to) / 2] ^= 1;
  expect_found(flipped, "does not fit");
  std::string dropped = whole;
  dropped.erase(a.from, b.from - a.from);  // with its index and its seal
  expect_found(dropped, "does not fit");
  const std::string reordered = whole.substr(0, a.from) + text(b) +
                                whole.substr(a.to, b.from - a.to) + text(a) + whole.substr(b.to);
  expect_found(reordered, "does not fit");
  expect_found(whole.substr(0, chunks.back().from), "not closed");
  std::string appended = whole;
  const auto records = records_of(whole);
  const auto end = std::find_if(records.begin(), records.end(),
                                [](const auto& r) { return r.opcode == mcap::kDataEnd; });
  appended.insert(end->from, text(a));
  expect_found(appended, "added behind the last seal");
  expect_found(whole + text(a), "does not end behind its index");
}

/// Each byte of the data, by one bit: the front, chunks, indexes of messages, seals themselves.
TEST_F(SignedLog, NoBitOfTheDataChangesInSilence) {
  const std::string whole = written("hall");
  const auto records = records_of(whole);
  const auto end = std::find_if(records.begin(), records.end(),
                                [](const auto& r) { return r.opcode == mcap::kDataEnd; });
  const std::vector<fs::path> files{file("log.mcap")};
  std::size_t tried = 0;
  for (std::size_t at = 0; at < end->from; at += 7, ++tried) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
    std::ofstream(files[0], std::ios::binary) << flipped;
    const auto why_not = why_not_signed(files, (*site_)["anna"]);
    ASSERT_TRUE(why_not) << why_not.error().text;
    EXPECT_NE(*why_not, "") << "byte " << at;
  }
  EXPECT_GT(tried, 500U);
}

/// Each byte behind the last seal, by one bit; and an index that is whole and says something else.
TEST_F(SignedLog, AnIndexThatWasChangedIsFound) {
  const std::string whole = written("hall");
  const auto records = records_of(whole);
  const auto end = std::find_if(records.begin(), records.end(),
                                [](const auto& r) { return r.opcode == mcap::kDataEnd; });
  const std::vector<fs::path> files{file("log.mcap")};
  const auto why_not = [&](const std::string& bytes) {
    std::ofstream(files[0], std::ios::binary) << bytes;
    return why_not_signed(files, (*site_)["anna"]).value();
  };
  EXPECT_EQ(why_not(whole), "");
  ASSERT_GT(whole.size() - end->from, 1000U);
  for (std::size_t at = end->from; at < whole.size(); at += at % 5 + 1) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << (at % 8)));
    EXPECT_NE(why_not(flipped), "") << "byte " << at;
  }
  // Increments are read as poses would be, that is not at all: with a checksum that fits.
  std::string forged = whole;
  for (const char* topic : {"/increments", "/incremenuz"}) {
    const std::size_t at = forged.find("/increments", end->from);
    ASSERT_NE(at, std::string::npos);
    forged.replace(at, 11, topic);
    const std::uint32_t crc = crc32(std::as_bytes(
        std::span(forged).subspan(end->to, forged.size() - mcap::kMagic.size() - 4 - end->to)));
    std::memcpy(forged.data() + forged.size() - mcap::kMagic.size() - 4, &crc, 4);
    const std::string why = why_not(forged);
    if (std::string(topic) == "/increments")
      EXPECT_EQ(why, "") << "the same once more";
    else
      EXPECT_NE(why.find("the index was changed"), std::string::npos) << why;
  }
  EXPECT_NE(why_not(whole.substr(0, end->to)).find("cut off"), std::string::npos);
}

/// As a crash leaves it: what is covered, and what is not.
TEST_F(SignedLog, OfOneThatWasNeverClosedIsToldWhatIsCovered) {
  const std::string whole = written("hall");
  std::vector<RecordPlace> chunks;
  for (const RecordPlace& record : records_of(whole))
    if (record.opcode == mcap::kChunk) chunks.push_back(record);
  ASSERT_GT(chunks.size(), 4U);
  const std::size_t cut = chunks[3].from;
  expect_found(whole.substr(0, cut), "not closed");
  const std::string covered =
      "4 seals of hall cover its first " + std::to_string(cut) + " bytes, up to tick ";
  expect_found(whole.substr(0, cut), covered);
  expect_found(whole.substr(0, cut), "no byte stands behind them");
  const auto read = read_session_log(file("log.mcap"));
  ASSERT_TRUE(read) << read.error().text;
  const std::string tick = std::to_string(read->ticks.back().tick) + "; ";
  expect_found(whole.substr(0, cut), "up to tick " + tick);
  expect_found(whole.substr(0, cut + 30), covered + tick + "the 30 bytes behind them are not");
  const std::size_t behind = chunks[3].to - cut;  // a whole chunk whose seal was not written
  expect_found(whole.substr(0, chunks[3].to), "behind the last seal is not sealed; " + covered +
                                                  tick + "the " + std::to_string(behind) +
                                                  " bytes");
  std::string flipped = whole;
  flipped[cut + 100] ^= 1;
  expect_found(flipped, covered + tick);
}

TEST_F(SignedLog, WhoIsNoServerOfTheSiteProvesNothing) {
  expect_found(written(""), "not signed");
  expect_found(written("anna"), "not that of a server");
  const test::KeyRing other("others", "elsewhere");
  const test::Outcome foreign = verify(written("hall"), other["site"]);
  EXPECT_EQ(foreign.exit_code, 4) << foreign.out;
  EXPECT_NE(foreign.out.find("not of this site"), std::string::npos) << foreign.out;
  const std::string by_gone = written("gone");
  EXPECT_EQ(verify(by_gone).exit_code, 0);
  site_->revoke("gone");
  const test::Outcome revoked = verify(by_gone, (*site_)["site"]);
  EXPECT_NE(revoked.out.find("has been revoked"), std::string::npos) << revoked.out;
  EXPECT_EQ(verify(by_gone, folder_.path().string()).exit_code, 3) << "no authority there";
  EXPECT_EQ(test::run("mortise-replay", "verify '" + file("log.mcap").string() + "'").exit_code, 0)
      << "who does not ask is not told";
}

/// Rotated and restarted: a file says up to which seal it read the one before.
TEST_F(SignedLog, FilesOfOneSessionHangTogether) {
  const KeyFiles keys((*site_)["hall"]);
  LogHeader header = session_->header;
  LogOptions options{.signer = *LogSigner::open(keys.certificate, keys.key)};
  const auto begun = [&](const std::string& name) {
    auto writer = SessionLogWriter::create(file(name), header, options);
    EXPECT_TRUE(writer) << writer.error().text;
    return std::move(*writer);
  };
  auto first = begun("a.mcap");
  for (const TickRecord& tick : session_->ticks) first->record(tick);
  ASSERT_TRUE(first->flush());
  fs::copy_file(file("a.mcap"), file("killed.mcap"));  // as a crash leaves it
  ASSERT_TRUE(first->close());
  const std::vector<fs::path> killed{file("killed.mcap")};
  EXPECT_NE(why_not_signed(killed, (*site_)["hall"])->find("not closed"), std::string::npos);

  const auto seals = check_seals(killed[0], (*site_)["hall"]);
  ASSERT_TRUE(seals);
  EXPECT_EQ(seals->trouble, "");
  EXPECT_LT(fs::file_size(killed[0]) - seals->proven_bytes, 1000U) << "behind it: the seal alone";
  const auto read = read_session_log(killed[0]);
  ASSERT_TRUE(read) << read.error().text;
  ASSERT_TRUE(seals->digests.contains(read->last_seal));
  header.chain = {"killed.mcap", 2, read->last_seal};
  ASSERT_TRUE(begun("b.mcap")->close());
  const std::vector<fs::path> both{file("killed.mcap"), file("b.mcap")};
  EXPECT_EQ(*why_not_signed(both, (*site_)["hall"]), "");
  header.chain.previous_seal = std::string(64, '0');
  ASSERT_TRUE(begun("c.mcap")->close());
  const std::vector<fs::path> wrong{file("killed.mcap"), file("c.mcap")};
  EXPECT_NE(why_not_signed(wrong, (*site_)["hall"])->find("does not go on from"),
            std::string::npos);
}

}  // namespace
}  // namespace mortise
