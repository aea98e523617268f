(function (eval) {
  return function () {
    try { eval('throw 0;\n' + arguments[0]); } catch (error) { if (error !== 0) throw error; }
  };
})(eval)
