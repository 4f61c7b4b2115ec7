#include "traces/files/program_reader.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <span>

#include "traces/files/draw_state_names.h"
#include "traces/files/material_names.h"
#include "traces/files/program_names.h"

namespace beampipe {
namespace {

constexpr std::uint32_t kMostWord = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint32_t kMostImageSide = 16384, kMostImageDepth = 2048, kMostImageLayers = 6 * 2048;
constexpr std::uint32_t kMostLocation = 255;
constexpr std::uint32_t kMostImageLevels = std::bit_width(kMostImageSide);
constexpr float kMostLod = 1000, kMostReal = std::numeric_limits<float>::max();

// An index into a list that is read before.
template <class Item>
Form<std::uint32_t> index_form(const std::vector<Item>& items, const char* where) {
  Json schema = {{"type", "integer"}, {"minimum", 0}};
  return {schema, [&items, where](const JsonCursor& at, std::uint32_t& index) {
            if (items.empty()) at.fail(std::string("an index into ") + where + ", which has none");
            index = at.integer(0, static_cast<std::uint32_t>(items.size() - 1));
          }};
}

Form<std::vector<std::uint8_t>> bytes_form(const ArrayReader& arrays) {
  return {bytes_schema(),
          [&arrays](const JsonCursor& at, std::vector<std::uint8_t>& bytes) { bytes = arrays.bytes(at); }};
}

template <class Number, std::size_t Count>
std::array<Number, Count> elements_of(const JsonCursor& at, const Form<Number>& element) {
  const std::vector<JsonCursor> elements = at.elements();
  if (elements.size() != Count) at.fail("an array of " + std::to_string(Count));
  std::array<Number, Count> values{};
  for (std::size_t i = 0; i < Count; ++i) element.read(elements[i], values[i]);
  return values;
}

Form<ProgramInput> program_input_form() {
  return ObjectForm<ProgramInput>()
      .required("location", &ProgramInput::location, form::integer(0, kMostLocation), "The location in the shader.")
      .optional("component", &ProgramInput::component, form::integer(0, 3), "The first component of the location.")
      .required("count", &ProgramInput::count, form::integer(1, 4), "How many components there are.")
      .optional("interpolation", &ProgramInput::interpolation, form::choice<InputInterpolation>(kInterpolationNames),
                "smooth: with perspective. linear: without it. flat: as the first vertex of the triangle has it.")
      .optional("integer", &ProgramInput::integer, form::boolean(), "Whether its bits are integers.")
      .check([](const JsonCursor& at, const ProgramInput& input) {
        if (input.component + input.count > 4)
          at["count"].fail("at most " + std::to_string(4 - input.component) + " components from component " +
                           std::to_string(input.component) + " on");
      });
}

Form<SpecializationConstant> specialization_form() {
  const Form<std::uint32_t> word = form::integer(0, kMostWord);
  return ObjectForm<SpecializationConstant>()
      .required("id", &SpecializationConstant::id, word, "Its SpecId.")
      .required("bits", &SpecializationConstant::bits, word, "Its value, as 32 bits.");
}

Form<ShaderProgram> program_form(const ArrayReader& arrays) {
  const Form<std::vector<std::uint32_t>> words = {
      numbers_schema(form::integer(0, kMostWord).schema, true),
      [&arrays](const JsonCursor& at, std::vector<std::uint32_t>& value) { value = arrays.words(at); }};
  return ObjectForm<ShaderProgram>()
      .required("name", &ShaderProgram::name, form::text(), "What messages call it.")
      .required("spirv", &ShaderProgram::spirv, words,
                "A SPIR-V module with one fragment shader, as words of 32 bits; in base64 the lowest byte comes first.")
      .optional("specialization", &ShaderProgram::specialization, form::list(specialization_form()),
                "Specialization constants.")
      .optional("inputs", &ShaderProgram::inputs, form::list(program_input_form()),
                "What the shader reads, in the order in which the `varyings` of meshes have it.");
}

void check_shape(const JsonCursor& at, const ProgramImage& image) {
  const bool is_cube = image.shape == ImageShape::cube, is_3d = image.shape == ImageShape::d3;
  if (image.shape == ImageShape::d1 && image.height != 1) at["height"].fail("a height of 1, as the image is 1d");
  if (is_cube && image.height != image.width)
    at["height"].fail("the width of the cube, " + std::to_string(image.width));
  if (!is_3d && image.depth != 1) at["depth"].fail("a depth of 1, as the image is not 3d");
  if (is_3d && (image.array || image.layers != 1)) at.fail("a 3d image of one layer that is no array");
  if (is_cube && (image.layers % 6 != 0 || (!image.array && image.layers != 6)))
    at.fail("six layers for each cube, and one cube where it is no array", std::to_string(image.layers));
  if (!is_cube && !image.array && image.layers != 1)
    at.fail("one layer, as the image is no array", std::to_string(image.layers));
  const std::uint32_t most_levels =
      static_cast<std::uint32_t>(std::bit_width(std::max({image.width, image.height, image.depth})));
  if (image.levels > most_levels) at["levels"].fail("at most " + std::to_string(most_levels) + " levels");
  const std::uint64_t bytes = level_start(image, image.levels);
  if (image.texels.size() != bytes)
    at["texels"].fail(std::to_string(bytes) + " bytes", std::to_string(image.texels.size()));
}

Form<ProgramImage> image_form(const ArrayReader& arrays) {
  const Form<std::uint32_t> side = form::integer(1, kMostImageSide);
  return ObjectForm<ProgramImage>()
      .required("name", &ProgramImage::name, form::text(), "What messages call it.")
      .required("shape", &ProgramImage::shape, form::choice<ImageShape>(kImageShapeNames), "Its dimensions.")
      .required("format", &ProgramImage::format, form::choice<TexelFormat>(kTexelFormatNames),
                "As Vulkan calls it, without its prefix.")
      .required("width", &ProgramImage::width, side, "Texels of level 0.")
      .optional("height", &ProgramImage::height, side, "Texels of level 0.")
      .optional("depth", &ProgramImage::depth, form::integer(1, kMostImageDepth), "Texels of level 0.")
      .optional("layers", &ProgramImage::layers, form::integer(1, kMostImageLayers), "Layers; six for each cube.")
      .optional("array", &ProgramImage::array, form::boolean(), "Whether shaders see an array.")
      .optional("levels", &ProgramImage::levels, form::integer(1, kMostImageLevels), "Mip levels.")
      .required("texels", &ProgramImage::texels, bytes_form(arrays),
                "Level by level, in a level layer by layer or slice by slice, row by row from v = 0 on, without gaps.")
      .check(check_shape);
}

Form<ProgramSampler> sampler_form() {
  const Form<Filter> filter = form::choice<Filter>(kFilterNames);
  const Form<SamplerWrap> wrap = form::choice<SamplerWrap>(kSamplerWrapNames);
  const Form<float> lod = form::real(-kMostLod, kMostLod), number = form::real(-kMostReal, kMostReal);
  const Form<std::array<SamplerWrap, 3>> wraps = {form::array_schema(wrap.schema, 3),
                                                  [wrap](const JsonCursor& at, std::array<SamplerWrap, 3>& value) {
                                                    value = elements_of<SamplerWrap, 3>(at, wrap);
                                                  }};
  const Form<glm::vec4> border = {form::array_schema(number.schema, 4),
                                  [number](const JsonCursor& at, glm::vec4& value) {
                                    const auto [r, g, b, a] = elements_of<float, 4>(at, number);
                                    value = {r, g, b, a};
                                  }};
  return ObjectForm<ProgramSampler>()
      .optional("mag", &ProgramSampler::mag, filter, "The filter where a texel is larger than a pixel.")
      .optional("min", &ProgramSampler::min, filter, "The filter where a texel is smaller.")
      .optional("mip", &ProgramSampler::mip, filter, "How levels are chosen: the nearest one, or a mix of two.")
      .optional("wrap", &ProgramSampler::wrap, wraps, "What is beyond the edges, along u, v and w.")
      .optional("lod_bias", &ProgramSampler::lod_bias, lod, "Added to the level of detail.")
      .optional("least_lod", &ProgramSampler::least_lod, lod, "The least level of detail.")
      .optional("most_lod", &ProgramSampler::most_lod, lod, "The largest level of detail.")
      .optional("anisotropy", &ProgramSampler::anisotropy, form::real(1, 16), "1 is none.")
      .optional("compare", &ProgramSampler::compare, form::choice<Compare>(kCompareNames),
                "What the reference must be, compared with a texel's depth, to give 1.")
      .optional("border", &ProgramSampler::border, border, "The colour beyond the edges.")
      .optional("unnormalized", &ProgramSampler::unnormalized, form::boolean(), "Whether coordinates are in texels.");
}

template <class Bound>
ObjectForm<Bound> binding_form() {
  const Form<std::uint32_t> number = form::integer(0, kMostWord);
  ObjectForm<Bound> bound;
  bound.required("set", &Bound::set, number, "The descriptor set.")
      .required("binding", &Bound::binding, number, "The binding.")
      .optional("element", &Bound::element, number, "Of an array.");
  return bound;
}

void read_swizzle(const JsonCursor& at, std::string& swizzle) {
  swizzle = at.string();
  if (swizzle.size() != 4 || swizzle.find_first_not_of(kSwizzleLetters) != std::string::npos)
    at.fail("four letters of \"rgba01\"");
}

void check_view(const JsonCursor& at, const std::vector<ProgramImage>& images, const BoundImage& bound) {
  if (!bound.image) {
    if (!bound.sampler) at.fail("the key \"image\" or \"sampler\"", "none");
    return;
  }
  const ProgramImage& image = images[*bound.image];
  const auto check = [&](const char* first_key, std::uint32_t first, const char* count_key,
                         const std::optional<std::uint32_t>& count, std::uint32_t all) {
    const std::string of_image = " of the image's " + std::to_string(all);
    if (first >= all) at[first_key].fail("one" + of_image);
    if (count && *count > all - first) at[count_key].fail("at most those" + of_image);
  };
  check("base_level", bound.base_level, "levels", bound.levels, image.levels);
  check("base_layer", bound.base_layer, "layers", bound.layers, image.layers);
}

Form<BoundImage> bound_image_form(const Trace& trace) {
  const Form<std::string> swizzle = {form::text().schema, read_swizzle};
  const Form<std::uint32_t> number = form::integer(0, kMostWord), count = form::integer(1, kMostWord);
  return binding_form<BoundImage>()
      .optional("image", &BoundImage::image, index_form(trace.program_images, "/program_images"),
                "The number of one of `program_images`, from 0.")
      .optional("sampler", &BoundImage::sampler, index_form(trace.program_samplers, "/program_samplers"),
                "The number of one of `program_samplers`, from 0.")
      .optional("swizzle", &BoundImage::swizzle, swizzle,
                "The channel that each component shows; \"0\" and \"1\" are numbers.")
      .optional("base_level", &BoundImage::base_level, number, "The first level that is seen.")
      .optional("base_layer", &BoundImage::base_layer, number, "The first layer that is seen.")
      .optional("levels", &BoundImage::levels, count, "How many levels are seen; all that follow when left out.")
      .optional("layers", &BoundImage::layers, count, "How many layers are seen; all that follow when left out.")
      .check([&trace](const JsonCursor& at, const BoundImage& bound) { check_view(at, trace.program_images, bound); });
}

}  // namespace

Form<std::vector<ShaderProgram>> programs_form(const ArrayReader& arrays) { return form::list(program_form(arrays)); }

Form<std::vector<ProgramImage>> program_images_form(const ArrayReader& arrays) {
  return form::list(image_form(arrays));
}

Form<std::vector<ProgramSampler>> program_samplers_form() { return form::list(sampler_form()); }

Form<ProgramUse> program_use_form(const ArrayReader& arrays, const Trace& trace) {
  const Form<BoundBuffer> buffer =
      binding_form<BoundBuffer>().required("bytes", &BoundBuffer::bytes, bytes_form(arrays), "What it holds.");
  return ObjectForm<ProgramUse>()
      .required("program", &ProgramUse::program, index_form(trace.programs, "/programs"),
                "The number of one of `programs`, from 0.")
      .optional("buffers", &ProgramUse::buffers, form::list(buffer), "Uniform and storage buffers.")
      .optional("push_constants", &ProgramUse::push_constants, bytes_form(arrays), "Push constants, from offset 0 on.")
      .optional("images", &ProgramUse::images, form::list(bound_image_form(trace)), "Images and samplers.");
}

void expect_varyings(const JsonCursor& at, const Trace& trace, const Draw& draw) {
  const Mesh& mesh = trace.meshes[draw.mesh];
  const std::uint64_t each = varyings_of(trace.programs[draw.program->program]), all = each * mesh.positions.size();
  if (mesh.varyings.size() != all)
    at.fail("a mesh with " + std::to_string(all) + " varyings, " + std::to_string(each) + " for each vertex",
            std::to_string(mesh.varyings.size()) + " in mesh " + in_quotes(mesh.name));
}

Form<ColorTarget> color_target_form() { return form::choice<ColorTarget>(kColorTargetNames); }

}  // namespace beampipe
