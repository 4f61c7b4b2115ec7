// What exceptions say.
#pragma once

#include <string>

namespace beampipe {

// The message of the exception that `call` throws; "no error" if it throws none.
template <class Exception, class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Exception& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace beampipe
