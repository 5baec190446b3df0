#include "apps/picture/egl_context.h"

#define EGL_NO_X11  // NOLINT(readability-identifier-naming): EGL's own switch.
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <stdexcept>

namespace mjcf_pdg::app {
namespace {

// Returns a display without any window system if Mesa offers it, else the default display. Throws
// std::runtime_error if there is none.
EGLDisplay InitializedDisplay() {
  const auto get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
      eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_platform_display != nullptr) {
    const EGLDisplay display =
        get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  }
  const EGLDisplay display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr)) return display;
  throw std::runtime_error("cannot render: no EGL display (is a driver such as Mesa installed?)");
}

}  // namespace

EglContext::EglContext() : display_(InitializedDisplay()) {
  constexpr EGLint kAttributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                    EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint num_configs = 0;
  if (eglBindAPI(EGL_OPENGL_API) &&
      eglChooseConfig(display_, kAttributes, &config, 1, &num_configs) && num_configs > 0) {
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) &&
        context_ != EGL_NO_CONTEXT) {
      return;
    }
  }
  eglTerminate(display_);
  throw std::runtime_error("cannot render: EGL gives no OpenGL context without a surface");
}

EglContext::~EglContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglTerminate(display_);
  eglReleaseThread();
}

}  // namespace mjcf_pdg::app
