#include "pipeline/technique.h"

#include <gtest/gtest.h>

namespace beampipe {
namespace {

TEST(Technique, FramebufferBytesAreThePublishedOnes) {
  // Slide 23 of Crassin et al. 2018: beam takes 42 bytes with colour. MSAA 8x and 32x with 4-byte depth and fp16 RGB
  // take 80 and 320.
  EXPECT_EQ(parse_technique("beam").framebuffer_bytes_per_pixel(), 42u);
  EXPECT_EQ(parse_technique("beam:rules=paper").framebuffer_bytes_per_pixel(), 42u);
  EXPECT_EQ(parse_technique("beam:rules=paper,storage=text").framebuffer_bytes_per_pixel(), 32u);
  EXPECT_EQ(parse_technique("msaa:8").framebuffer_bytes_per_pixel(), 80u);
  EXPECT_EQ(parse_technique("msaa:32").framebuffer_bytes_per_pixel(), 320u);
  EXPECT_EQ(parse_technique("alpha").framebuffer_bytes_per_pixel(), 10u);
}

TEST(Technique, StreamingStatesFitTheirBudgets) {
  EXPECT_EQ(parse_technique("beam:order=stream").framebuffer_bytes_per_pixel(), 80u);  // as many as an MSAA 8x buffer
  EXPECT_EQ(parse_technique("beam:order=stream,bits=64,layers=1").framebuffer_bytes_per_pixel(), 32u);
  EXPECT_EQ(parse_technique("beam:order=stream,bits=256,layers=1").framebuffer_bytes_per_pixel(), 80u);
  EXPECT_EQ(parse_technique("z3").framebuffer_bytes_per_pixel(), 50u);
  EXPECT_EQ(parse_technique("z3:shape=32x2").framebuffer_bytes_per_pixel(), 36u);
  EXPECT_EQ(parse_technique("z3:shape=128x3").framebuffer_bytes_per_pixel(), 74u);
}

TEST(Technique, EveryMsaaRateOfTheRangeIsKnown) {
  for (std::uint32_t samples = 1; samples <= 1024; samples *= 2) {
    const std::string spec = std::string("msaa:").append(std::to_string(samples));
    EXPECT_EQ(parse_technique(spec).samples, samples);
    EXPECT_EQ(parse_technique(spec).spec, spec);
  }
}

TEST(Technique, WrongSpecsSayWhatWasExpected) {
  for (const char* spec : {"",
                           "bean",
                           "msaa",
                           "msaa:",
                           "msaa:3",
                           "msaa:0",
                           "msaa:-8",
                           "msaa:8x",
                           "msaa:2048",
                           "msaa:8,8",
                           "beam:mask=fast",
                           "beam:rules=paper,bits=64",
                           "beam:bits=64,mask=exact",
                           "beam:order=primitive",
                           "beam:order=stream,layers=2",
                           "beam:order=stream,passes=0",
                           "beam:order=stream,passes=1.5",
                           "beam:rules=paper,order=stream",
                           "z3:layers=3",
                           "beam:fuzzy=mix",
                           "beam:rules=paper,tiny=2",
                           "beam:rules=paper,overlap=none",
                           "beam:rules=paper,slab=visible,slab=full",
                           "beam:",
                           "beam:mask=table,mask=table",
                           "alpha:1",
                           "reference:64",
                           "beam ",
                           "msaa:8,color=rgb8",
                           "msaa:8,at=corner",
                           "msaa:prepass",
                           "msaa:8,prepass,prepass",
                           "acaa",
                           "acaa:512",
                           "acaa:8,double=yes",
                           "taa",
                           "taa:32",
                           "taa:8,blend=0",
                           "taa:8,blend=1.5",
                           "taa:8,blend=x",
                           "dvm:8",
                           "dvm:seed=-1",
                           "dvm:seed=1.5",
                           "dvm:seed=4294967296",
                           "visibility:8",
                           "deferred:"}) {
    try {
      parse_technique(spec);
      ADD_FAILURE() << "'" << spec << "' was taken";
    } catch (const SpecError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(std::string("'").append(spec).append("'")), std::string::npos) << message;
      EXPECT_NE(message.find("expected"), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

}  // namespace
}  // namespace beampipe
