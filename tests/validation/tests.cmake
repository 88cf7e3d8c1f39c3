if(TARGET supple_validation)
  supple_test(validation LABEL unit LINKS supple_validation SOURCES validation/validation_test.cpp)
endif()
