"""Words that no package of a firmware may be named: reserved by a language, or taken by a library."""

import keyword

__all__ = ["RESERVED"]

_C11 = """
auto break case char const continue default do double else enum extern float for goto if inline int long
register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
while
"""
_CPP20 = """
alignas alignof and and_eq asm bitand bitor bool catch char8_t char16_t char32_t class co_await co_return
co_yield compl concept const_cast consteval constexpr constinit decltype delete dynamic_cast explicit
export false friend mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected
public reinterpret_cast requires static_assert static_cast template this thread_local throw true try
typeid typename using virtual wchar_t xor xor_eq final override import module std main
"""
_RUST = """
abstract as async await become box core crate alloc dyn fn gen impl in let loop macro match mod move mut
priv proc_macro pub ref self super test trait type typeof unsized unsafe use where yield
"""
_HEADERS = """
assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg
stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype
arduino wire spi wstring print stream linux unix api binary_sensor button esphome gpio i2c light logger
number optional ota select sensor text uart wifi
"""
RESERVED = frozenset(
    [*(_C11 + _CPP20 + _RUST + _HEADERS).split(), *(word.lower() for word in keyword.kwlist)]
)
"""Keywords of C11, C++20, Rust and Python, C headers, and names of Arduino, ESPHome and compilers."""
