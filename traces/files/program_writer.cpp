#include "traces/files/program_writer.h"

#include "traces/files/draw_state_names.h"
#include "traces/files/material_names.h"
#include "traces/files/program_names.h"

namespace beampipe {
namespace {

void write_input(TraceText& text, const ProgramInput& input) {
  const ProgramInput defaults;
  text.open_object();
  text.put_key("location");
  text.put_number(input.location);
  text.put_member("component", input.component, defaults.component);
  text.put_key("count");
  text.put_number(input.count);
  text.put_choice("interpolation", input.interpolation, defaults.interpolation, kInterpolationNames);
  text.put_member("integer", input.integer, defaults.integer);
  text.close_object();
}

void write_program(TraceText& text, const ShaderProgram& program) {
  text.open_object();
  text.put_key("name");
  text.put_name("a program", program.name);
  text.put_key("spirv");
  text.put_words(program.spirv);
  if (!program.specialization.empty()) {
    text.put_key("specialization");
    text.put("[");
    text.list(program.specialization, [&](const SpecializationConstant& constant) {
      text.put("{\"id\": " + std::to_string(constant.id) + ", \"bits\": " + std::to_string(constant.bits) + "}");
    });
    text.put("]");
  }
  if (!program.inputs.empty()) {
    text.put_key("inputs");
    text.put("[");
    text.list(program.inputs, [&](const ProgramInput& input) { write_input(text, input); });
    text.put("]");
  }
  text.close_object();
}

void write_image(TraceText& text, const ProgramImage& image) {
  if (image.texels.size() != level_start(image, image.levels))
    text.fail("program image " + in_quotes(image.name) + " has not the texels of its size");
  const ProgramImage defaults;
  text.open_object();
  text.put_key("name");
  text.put_name("an image", image.name);
  text.put_name_of("shape", image.shape, kImageShapeNames);
  text.put_name_of("format", image.format, kTexelFormatNames);
  text.put_key("width");
  text.put_number(image.width);
  text.put_member("height", image.height, defaults.height);
  text.put_member("depth", image.depth, defaults.depth);
  text.put_member("layers", image.layers, defaults.layers);
  text.put_member("array", image.array, defaults.array);
  text.put_member("levels", image.levels, defaults.levels);
  text.put_key("texels");
  text.put_bytes(image.texels);
  text.close_object();
}

void write_sampler(TraceText& text, const ProgramSampler& sampler) {
  const ProgramSampler defaults;
  text.open_object();
  text.put_choice("mag", sampler.mag, defaults.mag, kFilterNames);
  text.put_choice("min", sampler.min, defaults.min, kFilterNames);
  text.put_choice("mip", sampler.mip, defaults.mip, kFilterNames);
  if (sampler.wrap != defaults.wrap) {
    text.put_key("wrap");
    text.put("[");
    for (std::size_t i = 0; i < sampler.wrap.size(); ++i) {
      text.put(i > 0 ? ", \"" : "\"");
      text.put(kSamplerWrapNames[static_cast<std::size_t>(sampler.wrap[i])]);
      text.put("\"");
    }
    text.put("]");
  }
  text.put_member("lod_bias", sampler.lod_bias, defaults.lod_bias);
  text.put_member("least_lod", sampler.least_lod, defaults.least_lod);
  text.put_member("most_lod", sampler.most_lod, defaults.most_lod);
  text.put_member("anisotropy", sampler.anisotropy, defaults.anisotropy);
  if (sampler.compare) text.put_name_of("compare", *sampler.compare, kCompareNames);
  text.put_member("border", sampler.border, defaults.border);
  text.put_member("unnormalized", sampler.unnormalized, defaults.unnormalized);
  text.close_object();
}

template <class Bound>
void write_binding(TraceText& text, const Bound& bound) {
  text.put_key("set");
  text.put_number(bound.set);
  text.put_key("binding");
  text.put_number(bound.binding);
  text.put_member("element", bound.element, 0u);
}

void write_bound_image(TraceText& text, const BoundImage& bound, const Trace& trace) {
  if (bound.image && *bound.image >= trace.program_images.size()) text.fail("a draw names no image of programs");
  if (bound.sampler && *bound.sampler >= trace.program_samplers.size()) text.fail("a draw names no sampler");
  const BoundImage defaults;
  const auto put = [&](const char* key, const std::optional<std::uint32_t>& number) {
    if (!number) return;
    text.put_key(key);
    text.put_number(*number);
  };
  text.open_object();
  write_binding(text, bound);
  put("image", bound.image);
  put("sampler", bound.sampler);
  if (bound.swizzle != defaults.swizzle) text.put_member("swizzle", bound.swizzle);
  text.put_member("base_level", bound.base_level, defaults.base_level);
  text.put_member("base_layer", bound.base_layer, defaults.base_layer);
  put("levels", bound.levels);
  put("layers", bound.layers);
  text.close_object();
}

template <class Item, class PutItem>
void write_list(TraceText& text, const char* key, const std::vector<Item>& items, PutItem put_item) {
  if (items.empty()) return;
  text.put(",\n\"" + std::string(key) + "\": [");
  text.list(items, put_item);
  text.put("]");
}

}  // namespace

void write_programs(TraceText& text, const Trace& trace) {
  write_list(text, "program_images", trace.program_images,
             [&](const ProgramImage& image) { write_image(text, image); });
  write_list(text, "program_samplers", trace.program_samplers,
             [&](const ProgramSampler& sampler) { write_sampler(text, sampler); });
  write_list(text, "programs", trace.programs, [&](const ShaderProgram& program) { write_program(text, program); });
}

void write_program_use(TraceText& text, const ProgramUse& use, const Trace& trace) {
  text.put(",\n\"program\": {\"program\": ");
  text.put_number(use.program);
  write_list(text, "buffers", use.buffers, [&](const BoundBuffer& buffer) {
    text.open_object();
    write_binding(text, buffer);
    text.put_key("bytes");
    text.put_bytes(buffer.bytes);
    text.close_object();
  });
  if (!use.push_constants.empty()) {
    text.put(",\n\"push_constants\": ");
    text.put_bytes(use.push_constants);
  }
  write_list(text, "images", use.images, [&](const BoundImage& bound) { write_bound_image(text, bound, trace); });
  text.put("}");
}

}  // namespace beampipe
