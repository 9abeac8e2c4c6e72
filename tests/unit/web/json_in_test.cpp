// What browsers say: every kind of message, and a list of what is none.
#include "client/web/json_in.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>

namespace mortise::web {
namespace {

template <class T>
T read(const std::string& text) {
  const auto message = read_page_message(text);
  if (!message) {
    ADD_FAILURE() << text << ": " << message.error().text;
    return {};
  }
  const T* wish = std::get_if<T>(&*message);
  EXPECT_NE(wish, nullptr) << text;
  return wish == nullptr ? T{} : *wish;
}

TEST(PageMessage, ReadsWhatThePageSends) {
  EXPECT_EQ(read<JoinWish>(R"({"type":"join","name":"Änne 2"})").name, "Änne 2");
  EXPECT_EQ(read<JoinWish>(R"({"type":"join","name":"ann","page":"0123456789abcdef"})").page,
            "0123456789abcdef");
  const auto move = read<MoveWish>(R"({"type":"move","part":3,"t":[1,-2.5,1e-3],"r":[0,0,0.1]})");
  EXPECT_EQ(move.part, PartId{3});
  EXPECT_EQ(move.translation_mm, Vec3(1, -2.5, 1e-3));
  EXPECT_EQ(move.rotation_rad, Vec3(0, 0, 0.1));
  EXPECT_EQ(read<MoveWish>(R"({"type":"move","part":3,"r":[0,0,1]})").translation_mm,
            Vec3(0, 0, 0));
  const auto view = read<ViewWish>(R"({"type":"view","p":[1,2,3],"target":[0,0,0],"up":[0,0,1]})");
  EXPECT_EQ(view.p, Vec3(1, 2, 3));
  EXPECT_EQ(read<PingWish>(R"({"type":"ping","at":12.5})").at, 12.5);
  const auto seek = read<ReplayWish>(R"({"type":"replay","do":"seek","tick":600})");
  EXPECT_EQ(seek.what, ReplayWish::Do::kSeek);
  EXPECT_EQ(seek.tick, 600u);
}

CommandWish command(const std::string& rest) {
  std::string text = R"({"type":"command","id":9,)";
  return read<CommandWish>(text.append(rest).append("}"));
}

TEST(PageMessage, ReadsEveryCommand) {
  EXPECT_EQ(command(R"("do":"grab","part":2)").kind, CommandKind::kGrab);
  EXPECT_EQ(command(R"("do":"grab","part":2)").id, 9u);
  EXPECT_EQ(command(R"("do":"release","parts":[2,4])").details.parts,
            (std::vector<PartId>{PartId{2}, PartId{4}}));
  EXPECT_EQ(command(R"("do":"undo","part":2)").kind, CommandKind::kUndo);
  EXPECT_EQ(command(R"("do":"redo","part":2)").kind, CommandKind::kRedo);
  EXPECT_EQ(command(R"("do":"reset","part":2)").kind, CommandKind::kReset);
  EXPECT_EQ(command(R"("do":"ask","part":2)").kind, CommandKind::kAskHandOver);
  EXPECT_EQ(command(R"("do":"withdraw","part":2)").kind, CommandKind::kWithdraw);
  EXPECT_EQ(command(R"("do":"consent","part":2)").kind, CommandKind::kConsent);
  EXPECT_EQ(command(R"("do":"decline","part":2,"text":"no")").details.text, "no");
  EXPECT_EQ(command(R"("do":"policy","text":"slide")").details.text, "slide");
  const auto fit = command(
      R"("do":"fit","part":1,"feature":"bore","other":2,"other_feature":"j","text":"H7/g6")");
  EXPECT_EQ(fit.kind, CommandKind::kSetTolerance);
  EXPECT_EQ(fit.details.other_part, PartId{2});
  EXPECT_EQ(fit.details.feature + fit.details.other_feature, "borej");
  EXPECT_EQ(command(R"("do":"tolerance","part":1,"text":"±0.05")").details.text, "±0.05");
  EXPECT_EQ(command(R"("do":"exclude","part":1,"other":2,"text":"glued")").kind,
            CommandKind::kSetExclusion);
  const auto added =
      command(R"("do":"add_part","name":"cover","mesh":"0f","moving":true,"p":[1,2,3])");
  EXPECT_EQ(added.kind, CommandKind::kAddPart);
  ASSERT_TRUE(added.details.edit);
  EXPECT_EQ(added.details.edit->name, "cover");
  EXPECT_EQ(added.details.edit->mesh_hash, "0f");
  EXPECT_TRUE(added.details.edit->moving);
  EXPECT_EQ(added.details.edit->X_WP.p, Vec3(1, 2, 3));
  EXPECT_EQ(added.details.edit->X_WP.q.w(), 1.0);
  const auto turned = command(
      R"("do":"add_part","name":"a","mesh":"0f","moving":false,"p":[1,2,3],"q":[0,0,0.6,0.8])");
  EXPECT_EQ(turned.details.edit->X_WP.q.coeffs(), Eigen::Vector4d(0, 0, 0.6, 0.8));
  for (const char* q : {"[0,0,0,2]", "[0,0,1]", "7", "[0,0,0,\"1\"]"})
    EXPECT_FALSE(read_page_message(
        std::string(R"({"type":"command","id":9,"do":"add_part","name":"a","mesh":"0f",)") +
        R"("moving":false,"q":)" + q + "}"))
        << q;
  EXPECT_EQ(command(R"("do":"remove_part","part":2)").kind, CommandKind::kRemovePart);
  const auto replaced = command(R"("do":"replace_part","part":2,"mesh":"0f")");
  EXPECT_EQ(replaced.kind, CommandKind::kReplacePart);
  EXPECT_EQ(replaced.part, PartId{2});
  ASSERT_TRUE(replaced.details.edit);
  EXPECT_EQ(replaced.details.edit->mesh_hash, "0f");
  const auto stands = command(R"("do":"set_moving","part":2,"moving":false)");
  EXPECT_EQ(stands.kind, CommandKind::kSetMoving);
  EXPECT_EQ(stands.part, PartId{2});
  ASSERT_TRUE(stands.details.edit);
  EXPECT_FALSE(stands.details.edit->moving);
  EXPECT_EQ(command(R"("do":"include","part":1,"other":2)").kind, CommandKind::kDropExclusion);
  const auto review = command(R"("do":"review","clash":5,"status":"approved","text":"ok")");
  EXPECT_EQ(review.details.clash, ClashId{5});
  EXPECT_EQ(review.details.status, ReviewStatus::kApproved);
  EXPECT_FALSE(review.details.other_user);
  const auto task = command(R"("do":"review","clash":5,"status":"active","assignee":2)");
  EXPECT_EQ(task.details.other_user, UserId{2});
  const auto constrain = command(
      R"("do":"constrain","kind":"coaxial","part":2,"feature":"a","other":1,"other_feature":"b","snap":true)");
  EXPECT_EQ(constrain.part, PartId{2});
  EXPECT_EQ(constrain.details.constraint.kind, ConstraintKind::kCoaxial);
  EXPECT_EQ(constrain.details.constraint.other.feature, "b");
  EXPECT_TRUE(constrain.details.constraint.snap);
  const auto snap = command(R"("do":"snap","part":2,"other":1)");
  EXPECT_EQ(snap.kind, CommandKind::kSnap);
  EXPECT_EQ(snap.details.constraint.held.part, PartId{2});
  EXPECT_EQ(snap.details.constraint.other.part, PartId{1});
  EXPECT_EQ(snap.details.constraint.kind, ConstraintKind::kUnknown);
  EXPECT_EQ(command(R"("do":"snap","part":2,"feature":"j")").details.constraint.held.feature, "j");
  EXPECT_EQ(command(R"("do":"unconstrain","part":2,"constraint":4)").details.constraint_id,
            ConstraintId{4});
}

TEST(PageMessage, RefusesWhatIsNone) {
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"", "not JSON"},
      {"{", "not JSON"},
      {"nul", "not JSON"},
      {"{\"type\":\"join\",\"name\":\"\xff\xfe\"}", "not JSON"},
      {R"({"type":"move","part":1,"t":[1e999,0,0]})", "not JSON"},
      {R"({"type":"move","part":1,"t":[NaN,0,0]})", "not JSON"},
      {std::string(10000, '['), "not JSON"},
      {"[]", "not a JSON object"},
      {"3", "not a JSON object"},
      {"null", "not a JSON object"},
      {"{}", "'type' is missing"},
      {R"({"type":3})", "'type' is not a text"},
      {R"({"type":"fly"})", "not a type of message"},
      {R"({"type":"join"})", "'name' is missing"},
      {R"({"type":"join","name":""})", "'name' is empty"},
      {R"({"type":"join","name":"ann","page":"guess me"})", "'page' has less than 16 bytes"},
      {R"({"type":"join","name":"a\nb"})", "not printable"},
      {R"({"type":"join","name":"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"})",
       "more than 64"},
      {R"({"type":"join","name":"a","role":"bot"})", "'role' is not a key"},
      {R"({"type":"move","part":0})", "ids begin with 1"},
      {R"({"type":"move","part":-1})", "'part'"},
      {R"({"type":"move","part":1.5})", "'part'"},
      {R"({"type":"move","part":4294967296})", "'part'"},
      {R"({"type":"move","part":"1"})", "'part' is not a number"},
      {R"({"type":"move","part":1,"t":[0,0]})", "three numbers"},
      {R"({"type":"move","part":1,"t":[0,0,null]})", "three numbers"},
      {R"({"type":"move","part":1,"t":{"x":1}})", "three numbers"},
      {R"({"type":"command","do":"grab","part":1})", "'id' is missing"},
      {R"({"type":"command","id":-1,"do":"grab","part":1})", "'id'"},
      {R"({"type":"command","id":1,"do":"fly"})", "no command 'fly'"},
      {R"({"type":"command","id":1,"do":"grab"})", "'part' is missing"},
      {R"({"type":"command","id":1,"do":"grab","parts":[]})", "list of 1 to"},
      {R"({"type":"command","id":1,"do":"grab","parts":[1,0]})", "ids begin with 1"},
      {R"({"type":"command","id":1,"do":"grab","part":1,"parts":[1]})", "'part' is not a key"},
      {R"({"type":"command","id":1,"do":"review","clash":1,"status":"great"})", "'great'"},
      {R"({"type":"command","id":1,"do":"review","clash":1,"status":3})", "not a text"},
      {R"({"type":"command","id":1,"do":"constrain","kind":"unknown","part":1,"feature":"a","other":2,"other_feature":"b"})",
       "may not be 'unknown'"},
      {R"({"type":"command","id":1,"do":"constrain","kind":"coaxial","part":1,"feature":"a","other":2,"other_feature":"b","snap":1})",
       "neither true nor false"},
      {R"({"type":"replay","do":"speed","speed":1000})", "0.1 to 16"},
      {R"({"type":"replay","do":"rewind"})", "must be play"},
  };
  for (const auto& [text, why] : bad) {
    const auto message = read_page_message(text);
    ASSERT_FALSE(message) << text;
    EXPECT_NE(message.error().text.find(why), std::string::npos)
        << text.substr(0, 80) << ": " << message.error().text;
    EXPECT_EQ(message.error().text.find('\n'), std::string::npos);
  }
}

TEST(PageMessage, SaysNoMoreThanOneLineOfWhatAStrangerWrote) {
  const auto message = read_page_message(R"({"type":"x\ny","a":1})");
  ASSERT_FALSE(message);
  EXPECT_EQ(message.error().text.find('\n'), std::string::npos);
}

// Good messages with a few bytes wrong: read or refused, never anything else.
TEST(PageMessage, SurvivesAnything) {
  const std::vector<std::string> seeds = {
      R"({"type":"join","name":"ann"})",
      R"({"type":"move","part":3,"t":[1,-2.5,1e-3],"r":[0,0,0.1]})",
      R"({"type":"command","id":9,"do":"grab","parts":[2,4]})",
      R"({"type":"command","id":9,"do":"constrain","kind":"coaxial","part":2,"feature":"a","other":1,"other_feature":"b","distance":2,"snap":true})",
      R"({"type":"view","p":[1,2,3],"target":[0,0,0],"up":[0,0,1]})"};
  std::mt19937 random(3);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = seeds[random() % seeds.size()];
    for (unsigned k = random() % 4; k-- > 0;) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random());
          break;
        case 1:
          text.erase(at, 1 + random() % 8);
          break;
        case 2:
          text.insert(at, std::string(seeds[0], random() % seeds[0].size(), random() % 20));
          break;
        default:
          text[at] = "\"[]{},:0-9e."[random() % 12];
      }
      if (text.empty()) text.push_back('x');
    }
    const auto message = read_page_message(text);
    if (!message) ++refused;
    if (message && std::holds_alternative<MoveWish>(*message)) {
      EXPECT_TRUE(std::get<MoveWish>(*message).translation_mm.allFinite());
      EXPECT_TRUE(std::get<MoveWish>(*message).part);
    }
  }
  EXPECT_GT(refused, 5000);
  EXPECT_LT(refused, 20000);
}

}  // namespace
}  // namespace mortise::web
