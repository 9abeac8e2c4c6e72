#include "idl/identity.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509_vfy.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <utility>
#include <vector>

namespace mortise {
namespace {

namespace fs = std::filesystem;

template <auto free>
struct Free {
  template <class T>
  void operator()(T* pointer) const {
    free(pointer);
  }
};
using Bio = std::unique_ptr<BIO, Free<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Free<X509_free>>;
using RevocationList = std::unique_ptr<X509_CRL, Free<X509_CRL_free>>;
using Key = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY_free>>;
using Name = std::unique_ptr<X509_NAME, Free<X509_NAME_free>>;

constexpr const char* kMakeThem = "; `mortise keys issue` makes such a folder";

Error bad(const fs::path& file, const std::string& text) {
  return fail(Code::kInvalidInput, file.string() + ": " + text);
}

/// Null when the file is not there or holds no such thing.
template <class Pointer, class Read>
Pointer read_pem(const fs::path& file, Read read) {
  const Bio bio(BIO_new_file(file.c_str(), "r"));
  Pointer value(bio ? read(bio.get(), nullptr, nullptr, nullptr) : nullptr);
  ERR_clear_error();
  return value;
}

std::string entry(const X509_NAME* name, int nid) {
  char text[128];
  const int length = X509_NAME_get_text_by_NID(name, nid, text, sizeof text);
  return length > 0 ? std::string(text, static_cast<std::size_t>(length)) : std::string();
}

std::string serial_text(const ASN1_INTEGER* serial) {
  const std::unique_ptr<BIGNUM, Free<BN_free>> number(ASN1_INTEGER_to_BN(serial, nullptr));
  const std::unique_ptr<char, void (*)(char*)> hex(BN_bn2hex(number.get()),
                                                   [](char* p) { OPENSSL_free(p); });
  return hex.get();
}

/// The DER form that certificates of mortise-keys have: strings in UTF-8, the serial printable.
Name name_of(const Identity& identity) {
  Name name(X509_NAME_new());
  const auto add = [&](int nid, const std::string& value) {
    X509_NAME_add_entry_by_NID(name.get(), nid, MBSTRING_UTF8,
                               reinterpret_cast<const unsigned char*>(value.data()),
                               static_cast<int>(value.size()), -1, 0);
  };
  add(NID_organizationName, identity.site);
  add(NID_organizationalUnitName, identity.role);
  add(NID_serialNumber, identity.serial);
  add(NID_commonName, identity.name);
  return name;
}

/// The first 12 hex digits of a GUID that belongs to this subject: a bit that is 1, then the
/// subject's SHA-256.
std::string guid_start(const Identity& identity) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (X509_NAME_digest(name_of(identity).get(), EVP_sha256(), digest.data(), &size) != 1) return {};
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  unsigned carried = 1;
  for (std::size_t i = 0; i < 6; ++i) {
    const unsigned byte = (carried << 7 | digest[i] >> 1) & 0xff;
    carried = digest[i] & 1U;
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

/// X509_V_OK, or why the certificate is not good now.
int verify(X509* certificate, X509* authority, X509_CRL* revocations) {
  const std::unique_ptr<X509_STORE, Free<X509_STORE_free>> store(X509_STORE_new());
  const std::unique_ptr<X509_STORE_CTX, Free<X509_STORE_CTX_free>> context(X509_STORE_CTX_new());
  X509_STORE_add_cert(store.get(), authority);
  X509_STORE_add_crl(store.get(), revocations);
  X509_STORE_CTX_init(context.get(), store.get(), certificate, nullptr);
  X509_STORE_CTX_set_flags(context.get(), X509_V_FLAG_CRL_CHECK);
  X509_verify_cert(context.get());
  const int error = X509_STORE_CTX_get_error(context.get());
  ERR_clear_error();
  return error;
}

std::string time_text(const ASN1_TIME* time) {
  const Bio bio(BIO_new(BIO_s_mem()));
  ASN1_TIME_print(bio.get(), time);
  char text[64];
  const int length = BIO_read(bio.get(), text, sizeof text);
  return length > 0 ? std::string(text, static_cast<std::size_t>(length)) : "?";
}

std::string what_is_wrong(int error, const Identity& identity, const X509* certificate) {
  const std::string whose = "the certificate of '" + identity.name + "' ";
  switch (error) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return whose + "expired on " + time_text(X509_get0_notAfter(certificate)) +
             "; issue a new one with mortise keys";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return whose + "is valid from " + time_text(X509_get0_notBefore(certificate)) +
             "; look at this machine's clock";
    case X509_V_ERR_CERT_REVOKED:
      return whose + "has been revoked; issue a new one with mortise keys";
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
      return whose + "is not of the authority in ca.crt beside it: it belongs to another site";
    default:
      return whose + "is not good: " + X509_verify_cert_error_string(error);
  }
}

}  // namespace

KeyFiles::KeyFiles(const fs::path& given) {
  std::error_code ignored;
  const fs::path folder = fs::absolute(given, ignored);
  authority = folder / "ca.crt";
  certificate = folder / "identity.crt";
  key = folder / "identity.key";
  governance = folder / "governance.p7s";
  permissions = folder / "permissions.p7s";
  revocations = folder / "crl.pem";
  const char* credentials = std::getenv("CREDENTIALS_DIRECTORY");
  if (credentials == nullptr) return;
  const fs::path handed_over = fs::path(credentials) / key.filename();
  std::string word;  // "none": what a unit hands over that was given no key
  if (std::ifstream(handed_over) >> word && word != "none") key = handed_over;
}

Result<Identity> identity_of_subject(const std::string& subject) {
  std::vector<std::string> values;
  std::size_t at = 0;
  for (const std::string key : {"/O=", "/OU=", "/serialNumber=", "/CN="}) {
    if (subject.compare(at, key.size(), key) != 0) {
      return fail(Code::kInvalidInput, "'" + subject + "' is no subject of mortise keys");
    }
    at += key.size();
    const std::size_t end = std::min(subject.find('/', at), subject.size());
    values.push_back(subject.substr(at, end - at));
    at = end;
  }
  const bool whole =
      at == subject.size() && std::none_of(values.begin(), values.end(),
                                           [](auto& v) { return v.empty() || v.size() > 64; });
  if (!whole) return fail(Code::kInvalidInput, "'" + subject + "' is no subject of mortise keys");
  return Identity{values[0], values[1], values[2], values[3]};
}

Result<Identity> check_keys(const fs::path& folder) {
  const KeyFiles files(folder);
  for (const fs::path& file : {files.governance, files.permissions}) {
    if (!fs::exists(file)) return bad(file, std::string("is not there") + kMakeThem);
  }
  const auto certificate = read_pem<Certificate>(files.certificate, PEM_read_bio_X509);
  if (!certificate) return bad(files.certificate, std::string("no certificate there") + kMakeThem);
  const auto authority = read_pem<Certificate>(files.authority, PEM_read_bio_X509);
  if (!authority) return bad(files.authority, std::string("no certificate there") + kMakeThem);
  const auto revocations = read_pem<RevocationList>(files.revocations, PEM_read_bio_X509_CRL);
  if (!revocations) return bad(files.revocations, std::string("no list there") + kMakeThem);
  const X509_NAME* subject = X509_get_subject_name(certificate.get());
  const Identity identity{entry(subject, NID_organizationName),
                          entry(subject, NID_organizationalUnitName),
                          entry(subject, NID_serialNumber), entry(subject, NID_commonName)};
  if (X509_NAME_cmp(name_of(identity).get(), subject) != 0) {
    return bad(files.certificate, std::string("is no certificate of mortise keys") + kMakeThem);
  }
  if (const int error = verify(certificate.get(), authority.get(), revocations.get());
      error != X509_V_OK) {
    return bad(files.certificate, what_is_wrong(error, identity, certificate.get()));
  }
  const std::string serial = serial_text(X509_get0_serialNumber(certificate.get()));
  if (serial != identity.serial) {
    return bad(files.certificate, "the certificate of '" + identity.name + "' has the serial " +
                                      serial + " and says " + identity.serial +
                                      ": it could not be taken back; revoke it and issue a new "
                                      "one with mortise keys");
  }
  const auto key = read_pem<Key>(files.key, PEM_read_bio_PrivateKey);
  if (!key || X509_check_private_key(certificate.get(), key.get()) != 1) {
    ERR_clear_error();
    return bad(files.key, "is not the key of identity.crt beside it");
  }
  return identity;
}

PeerIdentities::PeerIdentities(fs::path authority, fs::path revocations)
    : authority_(std::move(authority)), revocations_(std::move(revocations)) {
  const auto own = read_pem<Certificate>(authority_, PEM_read_bio_X509);
  if (own) {
    const std::unique_ptr<char, void (*)(char*)> text(
        X509_NAME_oneline(X509_get_subject_name(own.get()), nullptr, 0),
        [](char* p) { OPENSSL_free(p); });
    authority_subject_ = text.get();
  }
  read_revocations();
}

void PeerIdentities::met(const ClientKey& client, const std::string& subject) {
  const Result<Identity> claimed = identity_of_subject(subject);
  if (!claimed || guid_start(*claimed) != client.substr(0, 12)) return;
  const std::lock_guard lock(mutex_);
  known_[client].identity = *claimed;
  has_news_ = true;
}

void PeerIdentities::parted(const ClientKey& client) {
  const std::lock_guard lock(mutex_);
  known_.erase(client);
}

std::optional<Identity> PeerIdentities::identity_of(const ClientKey& client) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(client);
  return found == known_.end() ? std::nullopt : std::optional(found->second.identity);
}

std::string PeerIdentities::whose(const ClientKey& client) const {
  const std::optional<Identity> identity = identity_of(client);
  return identity ? "the certificate of '" + identity->name + "' (" + identity->role + ")"
                  : "a participant without a name (" + client + ")";
}

PeerIdentities::WhyNot PeerIdentities::why_not(const std::string& subject,
                                               const std::string& authority) const {
  if (subject.empty()) return {"without keys; start it with --keys", true};
  if (authority != authority_subject_) return {"of another site (" + authority + ")", true};
  return {"expired, not valid yet, or signed by no authority of this site", false};
}

bool PeerIdentities::is_revoked(const ClientKey& client) const {
  const std::lock_guard lock(mutex_);
  const auto found = known_.find(client);
  return found != known_.end() && revoked_.contains(found->second.identity.serial);
}

bool PeerIdentities::is_revoked(const Identity& identity) const {
  const std::lock_guard lock(mutex_);
  return revoked_.contains(identity.serial);
}

std::vector<ClientKey> PeerIdentities::newly_revoked() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked_at_ >= std::chrono::seconds(1)) {
    looked_at_ = now;
    std::error_code error;
    const auto changed = fs::last_write_time(revocations_, error);
    if (!error && changed != read_of_) read_revocations();
  }
  std::vector<ClientKey> clients;
  const std::lock_guard lock(mutex_);
  if (!std::exchange(has_news_, false)) return clients;
  for (auto& [client, known] : known_) {
    const bool is_news = !known.told;
    known.told = revoked_.contains(known.identity.serial);
    if (known.told && is_news) clients.push_back(client);
  }
  return clients;
}

void PeerIdentities::read_revocations() {
  std::error_code error;
  const auto changed = fs::last_write_time(revocations_, error);
  const auto list = read_pem<RevocationList>(revocations_, PEM_read_bio_X509_CRL);
  const auto authority = read_pem<Certificate>(authority_, PEM_read_bio_X509);
  if (error || !list || !authority) return;
  if (X509_CRL_verify(list.get(), X509_get0_pubkey(authority.get())) != 1) return ERR_clear_error();
  std::set<std::string> revoked;
  STACK_OF(X509_REVOKED)* entries = X509_CRL_get_REVOKED(list.get());
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    revoked.insert(serial_text(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(entries, i))));
  }
  const std::lock_guard lock(mutex_);
  revoked_ = std::move(revoked);
  has_news_ = true;
  read_of_ = changed;
}

}  // namespace mortise
