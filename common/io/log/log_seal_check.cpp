#include "common/io/log/log_seal_check.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509_vfy.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "common/io/log/input_file.h"
#include "common/io/log/log_index_check.h"
#include "common/io/log/log_layout.h"
#include "common/io/log/log_records.h"
#include "common/io/log/log_seal.h"
#include "common/io/log/mcap_format.h"
#include "common/io/log/mcap_index.h"
#include "common/io/log/mcap_reader.h"
#include "common/io/log/openssl_owner.h"
#include "common/io/state/bytes.h"

namespace mortise {
namespace {

namespace fs = std::filesystem;
using openssl::Certificate;

// Nothing of what is written in another way: one signature has one text.
std::vector<unsigned char> of_hexadecimal(const std::string& text) {
  std::vector<unsigned char> bytes;
  if (text.size() % 2 != 0 || text.find_first_not_of("0123456789abcdef") != std::string::npos)
    return bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(
        static_cast<unsigned char>(std::strtoul(text.substr(i, 2).c_str(), nullptr, 16)));
  return bytes;
}

std::string entry(const X509_NAME* subject, int which) {
  char text[128] = {};
  X509_NAME_get_text_by_NID(const_cast<X509_NAME*>(subject), which, text, sizeof text);
  return text;
}

/// The authority of a site, and whom it took its word back from.
class Site {
 public:
  explicit Site(const fs::path& folder)
      : authority_(
            openssl::of_pem<Certificate>(openssl::text_of(folder / "ca.crt"), PEM_read_bio_X509)),
        revoked_(openssl::of_pem<openssl::RevocationList>(openssl::text_of(folder / "crl.pem"),
                                                          PEM_read_bio_X509_CRL)) {
    ERR_clear_error();
  }
  bool is_known() const { return authority_ != nullptr; }

  /// Empty: it is that of a server of this site.
  std::string why_not(X509* certificate) const {
    const std::unique_ptr<X509_STORE, openssl::Free<X509_STORE_free>> store(X509_STORE_new());
    const std::unique_ptr<X509_STORE_CTX, openssl::Free<X509_STORE_CTX_free>> context(
        X509_STORE_CTX_new());
    X509_STORE_add_cert(store.get(), authority_.get());
    if (revoked_) X509_STORE_add_crl(store.get(), revoked_.get());
    X509_STORE_CTX_init(context.get(), store.get(), certificate, nullptr);
    X509_STORE_CTX_set_flags(context.get(),
                             X509_V_FLAG_NO_CHECK_TIME | (revoked_ ? X509_V_FLAG_CRL_CHECK : 0U));
    X509_verify_cert(context.get());
    const int error = X509_STORE_CTX_get_error(context.get());
    ERR_clear_error();
    if (error == X509_V_ERR_CERT_REVOKED) return "its certificate has been revoked";
    if (error != X509_V_OK) return "its certificate is not of this site";
    if (entry(X509_get_subject_name(certificate), NID_organizationalUnitName) != "server")
      return "its certificate is not that of a server";
    return "";
  }

 private:
  Certificate authority_;
  openssl::RevocationList revoked_;
};

bool is_signed(X509* by, const std::string& text, const std::vector<unsigned char>& signature) {
  const openssl::Digest context(EVP_MD_CTX_new());
  const bool good =
      EVP_DigestVerifyInit(context.get(), nullptr, EVP_sha256(), nullptr, X509_get0_pubkey(by)) ==
          1 &&
      EVP_DigestVerify(context.get(), signature.data(), signature.size(),
                       reinterpret_cast<const unsigned char*>(text.data()), text.size()) == 1;
  ERR_clear_error();
  return good;
}

struct Metadata {
  std::string name;
  std::map<std::string, std::string> values;
  std::string operator[](const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? "" : found->second;
  }
};

std::optional<Metadata> metadata_of(std::uint8_t opcode, std::span<const std::byte> content) {
  if (opcode != mcap::kMetadata) return std::nullopt;
  ByteReader reader(content);
  Metadata metadata;
  metadata.name = reader.string();
  metadata.values = mcap::read_map(reader);
  if (!reader.ok()) return std::nullopt;
  return metadata;
}

class Walk {
 public:
  Walk(const InputFile& file, const Site& site) : file_(file), site_(site) {}
  SealReport run();

 private:
  bool next();
  void record(std::uint8_t opcode, std::span<const std::byte> content);
  void seal(const Metadata& metadata);
  void behind_last_seal();
  void stop(const std::string& why);

  const InputFile& file_;
  const Site& site_;
  SealReport report_;
  Certificate certificate_;
  RunningDigest digest_;
  std::uint64_t at_ = 0;
  bool has_unsealed_ = false, last_sealed_ = false;
  ExpectedIndex index_;
  std::vector<std::byte> head_, content_;
};

void Walk::stop(const std::string& why) {
  report_.trouble = "byte " + std::to_string(at_) + ": " + why;
}

SealReport Walk::run() {
  digest_.add(file_.read(0, mcap::kMagic.size(), head_));
  at_ = mcap::kMagic.size();
  while (report_.trouble.empty() && !last_sealed_ && next()) {
  }
  if (!report_.trouble.empty()) return std::move(report_);
  if (report_.seals == 0)
    stop("there is no seal");
  else if (has_unsealed_)
    stop("what stands behind the last seal is not sealed");
  else if (last_sealed_)
    behind_last_seal();
  return std::move(report_);
}

// One record; false: no whole one is left.
bool Walk::next() {
  const auto head = file_.read(at_, mcap::kRecordHeaderBytes, head_);
  ByteReader reader(head);
  const std::uint8_t opcode = reader.u8();
  const std::uint64_t length = reader.u64();
  const std::uint64_t content_at = at_ + mcap::kRecordHeaderBytes;
  if (!reader.ok() || content_at > file_.size() || length > file_.size() - content_at) return false;
  const auto content = file_.read(content_at, length, content_);
  record(opcode, content);
  digest_.add(head);
  digest_.add(content);
  index_.record(at_, opcode, content);
  at_ = content_at + length;
  if (!has_unsealed_ && report_.trouble.empty()) report_.proven_bytes = at_;
  return true;
}

void Walk::record(std::uint8_t opcode, std::span<const std::byte> content) {
  const auto metadata = metadata_of(opcode, content);
  if (metadata && metadata->name == log_layout::kSealMetadata) return seal(*metadata);
  has_unsealed_ = true;
  if (!metadata) return;
  if (metadata->name == log_layout::kChainMetadata && report_.seals == 0)
    report_.previous_seal = (*metadata)["previous_seal"];
  if (metadata->name != log_layout::kSignerMetadata) return;
  if (report_.seals > 0) return stop("another signer");
  certificate_ = openssl::of_pem<Certificate>((*metadata)["certificate"], PEM_read_bio_X509);
}

void Walk::seal(const Metadata& metadata) {
  const std::string number = std::to_string(report_.seals + 1);
  const std::string digest = digest_.take();
  last_sealed_ = metadata["last"] == "yes";
  if (metadata["sha256"] != digest)
    return stop("seal " + number + " does not fit: what it is of was changed");
  if (metadata["number"] != number) return stop("this is not seal " + number);
  if (metadata["signature"].empty() || !certificate_)
    return stop("the log is not signed: its server had no keys");
  if (report_.seals == 0) {
    if (const std::string why = site_.why_not(certificate_.get()); !why.empty())
      return stop("whoever signed it is not trusted: " + why);
    report_.signer = entry(X509_get_subject_name(certificate_.get()), NID_commonName);
  }
  if (!is_signed(certificate_.get(), seal_text(report_.seals + 1, last_sealed_, digest),
                 of_hexadecimal(metadata["signature"])))
    return stop("the signature of seal " + number + " is not good");
  ++report_.seals;
  report_.digests.insert(digest);
  has_unsealed_ = false;
}

// Only the index may stand there, as it follows from what is sealed, and the file ends with it.
void Walk::behind_last_seal() {
  const std::vector<std::byte> expected = index_.end(at_);
  const auto found = file_.read(at_, std::max(expected.size() + 1, head_.size()), content_);
  const auto [differs, wanted] = std::ranges::mismatch(found, expected);
  report_.is_closed = differs == found.end() && wanted == expected.end();
  if (report_.is_closed) return;
  if (differs == found.end()) return stop("it is cut off behind its last seal");
  if (differs == found.begin()) return stop("a record was added behind the last seal");
  at_ += static_cast<std::uint64_t>(differs - found.begin());
  stop(wanted == expected.end() ? "the file does not end behind its index"
                                : "the index was changed: it does not fit what is sealed");
}

// The last tick that ends in the first `bytes` of a file; 0: none.
std::uint64_t last_tick_of(const fs::path& file, std::uint64_t bytes) {
  std::error_code error;
  const double share = static_cast<double>(bytes) / static_cast<double>(fs::file_size(file, error));
  std::uint64_t last = 0;
  bool is_beyond = false;
  const McapHandler handler{.on_message =
                                [&](const McapChannel& channel, const McapMessage& message) {
                                  log_records::TickEnd end;
                                  if (!is_beyond && channel.topic == log_layout::kTicks &&
                                      log_records::decode(message.data, end))
                                    last = end.tick;
                                },
                            .on_progress = [&](double read) { is_beyond = read >= share; },
                            .is_enough = [&] { return is_beyond; }};
  if (!scan_mcap(file, handler)) return 0;
  return last;
}

// What is proven of a file of which not all is.
std::string covered_of(const fs::path& file, const SealReport& report) {
  if (report.seals == 0) return "nothing of it is covered by a seal";
  std::error_code error;
  const std::uint64_t behind = fs::file_size(file, error) - report.proven_bytes;
  return std::to_string(report.seals) + " seals of " + report.signer + " cover its first " +
         std::to_string(report.proven_bytes) + " bytes, up to tick " +
         std::to_string(last_tick_of(file, report.proven_bytes)) + "; " +
         (behind == 0 ? "no byte stands behind them"
                      : "the " + std::to_string(behind) + " bytes behind them are not covered") +
         ", and whether more was recorded cannot be told";
}

}  // namespace

Result<SealReport> check_seals(const fs::path& file, const fs::path& site) {
  const Site trusted(site);
  if (!trusted.is_known())
    return fail(Code::kInvalidInput, (site / "ca.crt").string() +
                                         ": no certificate there; name the folder of the site's "
                                         "authority, or of any identity of it");
  const InputFile input(file);
  if (!input.is_open()) return fail(Code::kNotFound, file.string() + ": cannot open the log");
  return Walk(input, trusted).run();
}

Result<std::string> why_not_signed(std::span<const fs::path> files, const fs::path& site) {
  std::optional<SealReport> before;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string name = files[i].string() + ": ";
    Result<SealReport> report = check_seals(files[i], site);
    if (!report) return report.error();
    if (!report->trouble.empty())
      return name + report->trouble + "; " + covered_of(files[i], *report);
    if (before && !before->digests.contains(report->previous_seal))
      return name + "it does not go on from a seal of the file before";
    if (i + 1 == files.size() && !report->is_closed)
      return name + "it was not closed: its end is missing; " + covered_of(files[i], *report);
    before = std::move(*report);
  }
  return std::string();
}

}  // namespace mortise
