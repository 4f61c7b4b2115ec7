#include "traces/files/base64.h"

#include "tests/test.h"

namespace beampipe::base64_test {

// RFC 4648, section 10, and bytes above 127.
const std::pair<const char*, const char*> kPairs[] = {
    {"", ""},
    {"f", "Zg=="},
    {"fo", "Zm8="},
    {"foo", "Zm9v"},
    {"foob", "Zm9vYg=="},
    {"fooba", "Zm9vYmE="},
    {"foobar", "Zm9vYmFy"},
    {"\xfb\xff\xfe", "+//+"},
};

TEST(Base64, EncodesAndDecodes) {
  for (const auto& [bytes, text] : kPairs) {
    EXPECT_EQ(to_base64(bytes), text);
    EXPECT_EQ(from_base64(text), bytes);
  }
  const std::string zeros(4, '\0');
  EXPECT_EQ(from_base64(to_base64(zeros)), zeros);
}

TEST(Base64, RefusesOtherTexts) {
  for (const char* text : {"Z", "Zg", "Zg=", "Zg===", "====", "=Zg=", "Z===", "Zm9v\n", "Zm 9", "Zm9-", "Zm9_",
                           "Zg==Zg==", "Zh==", "Zm9=", "Zm8=Zm8=", "Zm9\xc3"}) {
    EXPECT_EQ(from_base64(text), std::nullopt) << text;
  }
}

}  // namespace beampipe::base64_test
