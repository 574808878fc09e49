/* UTF-8: what is text, and what is not (RFC 3629). */
#include "base/utf8.h"

size_t laves__utf8_length(const unsigned char *text) {
  const unsigned char lead = text[0];
  if (lead < 0x80) return 1;
  const size_t length = lead >= 0xc2 && lead <= 0xdf ? 2 : (lead & 0xf0) == 0xe0 ? 3 : lead >= 0xf0 && lead <= 0xf4 ? 4 : 0;
  for (size_t i = 1; i < length; i++)
    if ((text[i] & 0xc0) != 0x80) return 0;
  if ((lead == 0xe0 && text[1] < 0xa0) || (lead == 0xed && text[1] > 0x9f)) return 0;
  if ((lead == 0xf0 && text[1] < 0x90) || (lead == 0xf4 && text[1] > 0x8f)) return 0;
  return length;
}

bool laves__is_utf8(const char *text) {
  for (const unsigned char *at = (const unsigned char *)text; *at;) {
    const size_t length = laves__utf8_length(at);
    if (length == 0) return false;
    at += length;
  }
  return true;
}
