#include "tests/llvmpipe/llvmpipe.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace beampipe {
namespace {

constexpr const char* kTriangleVertex = R"(#version 450
layout(location = 0) uniform vec4 corner[3];
void main() { gl_Position = corner[gl_VertexID]; })";

constexpr const char* kWhite = R"(#version 450
out vec4 color;
void main() { color = vec4(1.0); })";

// Draws one triangle over the whole frame that turns the samples of each pixel into bits of an unsigned integer.
constexpr const char* kFrameVertex = R"(#version 450
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); })";

constexpr const char* kGather = R"(#version 450
layout(location = 0) uniform int samples;
layout(binding = 0) uniform sampler2DMS surface;
out uint mask;
void main() {
  mask = 0u;
  for (int s = 0; s < samples; ++s)
    if (texelFetch(surface, ivec2(gl_FragCoord.xy), s).r > 0.5) mask |= 1u << s;
})";

GLuint link(const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  const auto attach = [&](GLenum type, const char* source) {
    const GLuint shader = glCreateShader(type);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  };
  attach(GL_VERTEX_SHADER, vertex);
  attach(GL_FRAGMENT_SHADER, fragment);
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) throw std::runtime_error("a shader of the llvmpipe harness does not link");
  return program;
}

GLuint framebuffer_of(GLuint texture) {
  GLuint framebuffer = 0;
  glCreateFramebuffers(1, &framebuffer);
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
  if (glCheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw std::runtime_error("a framebuffer of the llvmpipe harness is not complete");
  return framebuffer;
}

}  // namespace

struct Llvmpipe::Objects {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  GLsizei size = 0;
  GLuint draw = 0, gather = 0, vertex_array = 0;
  GLuint surface[5] = {}, target[5] = {};  // indexed by the number of samples, 1 or 4
  GLuint masks = 0, mask_target = 0;

  void create() {
    draw = link(kTriangleVertex, kWhite);
    gather = link(kFrameVertex, kGather);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glCreateTextures(GL_TEXTURE_2D, 1, &surface[1]);  // llvmpipe turns 1 sample into 4 for a multisample texture
    glTextureStorage2D(surface[1], 1, GL_R32F, size, size);
    glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &surface[4]);
    glTextureStorage2DMultisample(surface[4], 4, GL_R32F, size, size, GL_TRUE);
    for (const int samples : {1, 4}) target[samples] = framebuffer_of(surface[samples]);
    glCreateTextures(GL_TEXTURE_2D, 1, &masks);
    glTextureStorage2D(masks, 1, GL_R32UI, size, size);
    mask_target = framebuffer_of(masks);
    glViewport(0, 0, size, size);
  }
};

Llvmpipe::Llvmpipe() : objects_(std::make_unique<Objects>()) {}

Llvmpipe::~Llvmpipe() {
  if (objects_->display == EGL_NO_DISPLAY) return;
  eglMakeCurrent(objects_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (objects_->context != EGL_NO_CONTEXT) eglDestroyContext(objects_->display, objects_->context);
  eglTerminate(objects_->display);
}

std::unique_ptr<Llvmpipe> Llvmpipe::start(int size, std::string& missing) {
  setenv("GALLIUM_DRIVER", "llvmpipe", 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  std::unique_ptr<Llvmpipe> mesa(new Llvmpipe);
  Objects& objects = *mesa->objects_;
  objects.size = size;
  objects.display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  missing = "no surfaceless EGL display (Debian: libegl-mesa0 libgl1-mesa-dri)";
  if (objects.display == EGL_NO_DISPLAY || !eglInitialize(objects.display, nullptr, nullptr)) return nullptr;
  constexpr EGLint kAttributes[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5, EGL_NONE};
  missing = "no OpenGL 4.5 context without a surface";
  if (!eglBindAPI(EGL_OPENGL_API)) return nullptr;
  objects.context = eglCreateContext(objects.display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes);
  if (objects.context == EGL_NO_CONTEXT) return nullptr;
  if (!eglMakeCurrent(objects.display, EGL_NO_SURFACE, EGL_NO_SURFACE, objects.context)) return nullptr;
  const auto text = [](GLenum what) { return std::string(reinterpret_cast<const char*>(glGetString(what))); };
  mesa->name_ = text(GL_RENDERER) + ", " + text(GL_VERSION);
  missing = "OpenGL is not llvmpipe's but " + mesa->name_;
  if (mesa->name_.find("llvmpipe") == std::string::npos) return nullptr;
  objects.create();
  return mesa;
}

// The first row of a framebuffer object in memory is the one at y = -1. Drawing upside down puts beampipe's row 0
// there, so that both mean the same by "top" for edges and sample positions.
std::vector<std::uint32_t> Llvmpipe::coverage(const glm::vec4 clip[3], int samples) {
  const Objects& objects = *objects_;
  glm::vec4 corners[3];
  for (int i = 0; i < 3; ++i) corners[i] = {clip[i].x, -clip[i].y, clip[i].z, clip[i].w};
  glBindFramebuffer(GL_FRAMEBUFFER, objects.target[samples]);
  glClear(GL_COLOR_BUFFER_BIT);
  glUseProgram(objects.draw);
  glUniform4fv(0, 3, &corners[0].x);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  const auto pixels = static_cast<std::size_t>(objects.size) * static_cast<std::size_t>(objects.size);
  std::vector<std::uint32_t> masks(pixels);
  if (samples == 1) {
    std::vector<float> covered(pixels);
    glReadPixels(0, 0, objects.size, objects.size, GL_RED, GL_FLOAT, covered.data());
    for (std::size_t i = 0; i < pixels; ++i) masks[i] = covered[i] > 0.5f;
  } else {
    glBindFramebuffer(GL_FRAMEBUFFER, objects.mask_target);
    glUseProgram(objects.gather);
    glUniform1i(0, samples);
    glBindTextureUnit(0, objects.surface[samples]);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glReadPixels(0, 0, objects.size, objects.size, GL_RED_INTEGER, GL_UNSIGNED_INT, masks.data());
  }
  if (glGetError() != GL_NO_ERROR) throw std::runtime_error("an OpenGL call of the llvmpipe harness failed");
  return masks;
}

std::vector<glm::ivec2> Llvmpipe::positions(int samples) {
  if (samples == 1) return {{8, 8}};  // by definition
  glBindFramebuffer(GL_FRAMEBUFFER, objects_->target[samples]);
  std::vector<glm::ivec2> found;
  for (int s = 0; s < samples; ++s) {
    float at[2] = {};
    glGetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(s), at);
    found.emplace_back(std::lround(16 * at[0]), std::lround(16 * at[1]));
  }
  return found;
}

}  // namespace beampipe
