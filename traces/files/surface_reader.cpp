#include "traces/files/surface_reader.h"

#include "traces/files/base64.h"
#include "traces/files/image_file.h"
#include "traces/files/input_file.h"
#include "traces/files/material_names.h"
#include "traces/files/side_file.h"

namespace beampipe {
namespace {

namespace fs = std::filesystem;

TextureImage read_image_file(const JsonCursor& at, const fs::path& file, std::uint64_t most_texels) {
  try {
    return decode_image(read_input_file(file, file.string(), kMostImageBytes), most_texels);
  } catch (const BadImage& bad) {
    fail_trace(at.where() + ": " + file.string(), bad.expected, bad.found);
  } catch (const TraceError& error) {  // finding the place takes time, and is done only where it is needed
    throw TraceError(at.where() + ": " + error.what());
  }
}

TextureImage read_inline_image(const JsonCursor& at, std::uint64_t most_texels) {
  const std::optional<std::string> bytes = from_base64(at.string());
  if (!bytes) at.fail("base64 text");
  try {
    return decode_image(*bytes, most_texels);
  } catch (const BadImage& bad) {
    at.fail(bad.expected, bad.found);
  }
}

// Forms of an image: the bytes in the trace, or a file.
struct ImageForms {
  Form<TextureImage> data, file;
};

ImageForms image_forms(const fs::path& trace_file, const ReadOptions& options, const std::uint64_t& texels) {
  const auto read_data = [&texels](const JsonCursor& at, TextureImage& image) {
    image = read_inline_image(at, kMostTexels - texels);
  };
  const auto read_file = [&trace_file, options, &texels](const JsonCursor& at, TextureImage& image) {
    image = read_image_file(at, side_file(at, trace_file, options.allow_outside), kMostTexels - texels);
  };
  Json base64 = form::text().schema;
  base64["contentEncoding"] = "base64";
  return {ObjectForm<TextureImage>().add({"data",
                                          "The bytes of such a file as base64 (RFC 4648, section 4), with "
                                          "padding and without line ends.",
                                          true, base64, read_data}),
          ObjectForm<TextureImage>().add({"file",
                                          "Path of a PNG or JPEG file, relative to the trace's folder, which it "
                                          "may not leave: neither by .. nor by a symbolic link. It becomes "
                                          "RGBA with 8 bits per channel: grey is expanded, 16 bits are "
                                          "rounded, and the numbers are taken as stored, whatever the file's "
                                          "gamma and colour profile. At most 16384 texels on each side.",
                                          true, form::text().schema, read_file})};
}

Form<Texture> texture_form(const NameIndex& images) {
  const Form<Wrap> wrap = form::choice<Wrap>(kWrapNames);
  const Form<Filter> filter = form::choice<Filter>(kFilterNames);
  return ObjectForm<Texture>()
      .required("image", &Texture::image, name_form(images, "the name of an image in /images"),
                "The name of one of `images`.")
      .optional("uv_set", &Texture::uv_set, form::integer(0, 1),
                "Which of the mesh's texture coordinates: 0 for `uv0`, 1 for `uv1`.")
      .optional("wrap_u", &Texture::wrap_u, wrap, "What is beyond the image's left and right edges.")
      .optional("wrap_v", &Texture::wrap_v, wrap, "What is beyond the image's upper and lower edges.")
      .optional("magnify", &Texture::magnify, filter, "The filter where a texel is larger than a pixel.")
      .optional("minify", &Texture::minify, filter, "The filter in a mip level where a texel is smaller than a pixel.")
      .optional("mip", &Texture::mip, form::choice<MipFilter>(kMipFilterNames),
                "none: always the image itself. nearest: the nearest mip level. linear: a mix of two levels.")
      .optional("anisotropy", &Texture::anisotropy, form::integer(1, 16),
                "At most so many probes along the longer side of what a pixel covers of the image; more than 1 only "
                "with `mip` linear.");
}

Form<Material> material_form(const NameIndex& images) {
  const Form<Texture> texture = texture_form(images);
  return ObjectForm<Material>()
      .optional("base_color", &Material::base_color, form::rgba(),
                "Linear RGB and opacity, multiplied by the texture and by the vertices' colours.")
      .optional("base_texture", &Material::base_texture, texture, "The base colour in sRGB, and opacity.")
      .optional("metallic", &Material::metallic, form::fraction(), "0 for dielectrics, 1 for metals.")
      .optional("roughness", &Material::roughness, form::fraction(),
                "0 for a mirror, 1 for a surface without highlights.")
      .optional("metallic_roughness_texture", &Material::metallic_roughness_texture, texture,
                "Multiplied by `roughness` (G) and `metallic` (B); linear.")
      .optional("normal_texture", &Material::normal_texture, texture,
                "A normal in tangent space, 0..255 for -1..1; linear.")
      .optional("normal_scale", &Material::normal_scale, form::real(-kMostNormalScale, kMostNormalScale),
                "Factor of the x and y of `normal_texture`.")
      .optional("emissive", &Material::emissive, form::color(), "Light that the surface emits, as linear RGB.")
      .optional("emissive_texture", &Material::emissive_texture, texture, "Multiplied by `emissive`; in sRGB.")
      .optional("alpha_mode", &Material::alpha_mode, form::choice<AlphaMode>(kAlphaModeNames),
                "opaque: opacity is ignored. mask: the surface is there where opacity is at least `alpha_cutoff`. "
                "blend: opacity mixes the surface with what is behind it.")
      .optional("alpha_cutoff", &Material::alpha_cutoff, form::fraction(),
                "The least opacity that is there, with `mask`.")
      .optional("double_sided", &Material::double_sided, form::boolean(), "Whether the back faces are drawn too.")
      .optional("unlit", &Material::unlit, form::boolean(),
                "Whether the colour is the base colour, whatever the lights.");
}

}  // namespace

std::uint32_t read_name(const JsonCursor& at, const NameIndex& index, const char* what) {
  const auto found = index.find(at.string());
  if (found == index.end()) at.fail(what);
  return found->second;
}

Form<std::uint32_t> name_form(const NameIndex& index, const char* what) {
  return {form::text().schema,
          [&index, what](const JsonCursor& at, std::uint32_t& number) { number = read_name(at, index, what); }};
}

Form<std::vector<TextureImage>> images_form(const fs::path& trace_file, const ReadOptions& options) {
  const auto texels = std::make_shared<std::uint64_t>(0);  // of the images that are read
  const auto [data, file] = image_forms(trace_file, options, *texels);
  const Json schema = {{"type", "object"},
                       {"additionalProperties", {{"oneOf", Json::array({file.schema, data.schema})}}}};
  return {schema, [texels, data = data, file = file](const JsonCursor& at, std::vector<TextureImage>& images) {
            for (const auto& [name, each] : at.members()) {
              if (!each.has("file") && !each.has("data")) each.fail("the key \"file\" or \"data\"", "none");
              images.push_back((each.has("data") ? data : file)(each));
              images.back().name = name;
              *texels += images.back().texels.size();
            }
          }};
}

Form<std::vector<Material>> materials_form(const NameIndex& images) {
  return form::named(material_form(images), &Material::name);
}

void expect_uvs(const JsonCursor& at, const Material& material, const Mesh& mesh) {
  if (mesh.triangles.empty()) return;
  for (const auto& [key, slot] : kTextureSlots) {
    const std::optional<Texture>& texture = material.*slot;
    if (!texture || !mesh.uvs[texture->uv_set].empty()) continue;
    at.fail("\"uv" + std::to_string(texture->uv_set) + "\" in mesh " + in_quotes(mesh.name) + ", for the " + key +
                " of material " + in_quotes(material.name),
            "none");
  }
}

}  // namespace beampipe
